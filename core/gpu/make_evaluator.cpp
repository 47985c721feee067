#include "core/gpu/make_evaluator.h"

#include "core/gpu/opencl_evaluator.h"

namespace sonoloft {

Result<std::unique_ptr<FieldEvaluator>> make_evaluator(DeviceChoice choice, int threads,
                                                       const std::function<void(const std::string&)>& log) {
  if (threads < 1)
    return fail(ErrorCode::invalid_argument,
                "cannot work with " + std::to_string(threads) + " threads; give at least 1");
  const auto say = [&](const std::string& line) {
    if (log) log(line);
  };
  if (choice != DeviceChoice::cpu) {
    const bool named = choice == DeviceChoice::opencl;
    auto opencl =
        make_opencl_evaluator(threads, KernelForm::by_device, named ? DeviceKinds::all : DeviceKinds::no_processors);
    if (opencl) say("field: " + (*opencl)->name());
    if (opencl || named) return opencl;
    say("field: not on OpenCL: " + opencl.error().message);
  }
  auto cpu = make_cpu_evaluator(threads);
  say("field: " + cpu->name());
  return cpu;
}

}  // namespace sonoloft
