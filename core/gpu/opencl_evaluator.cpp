#include "core/gpu/opencl_evaluator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/gpu/opencl_device.h"

namespace sonoloft {

extern const char kFieldKernelSource[];  // core/kernels/field.cl, embedded by the build

namespace {

using kernels::u32;

/// A buffer on the device that grows when it must.
class DeviceArray {
 public:
  /// Room for `bytes`; what was in it is gone when it grows.
  cl_int reserve(const cl::Context& context, std::size_t bytes) {
    if (bytes <= capacity_) return CL_SUCCESS;
    cl_int code = CL_SUCCESS;
    const std::size_t wanted = bytes + bytes / 2;
    buffer_ = cl::Buffer(context, CL_MEM_READ_WRITE, wanted, nullptr, &code);
    capacity_ = code == CL_SUCCESS ? wanted : 0;
    return code;
  }

  template <class Range>
  cl_int upload(const OpenClDevice& on, const Range& values) {
    const std::size_t bytes = values.size() * sizeof(*values.data());
    if (const cl_int code = reserve(on.context, bytes); code != CL_SUCCESS) return code;
    return on.queue.enqueueWriteBuffer(buffer_, CL_FALSE, 0, bytes, values.data());
  }

  [[nodiscard]] const cl::Buffer& buffer() const { return buffer_; }

 private:
  cl::Buffer buffer_;
  std::size_t capacity_ = 0;
};

class OpenClEvaluator final : public FieldEvaluator {
 public:
  OpenClEvaluator(OpenClDevice device, cl::Kernel kernel, u32 width)
      : on_(std::move(device)), kernel_(std::move(kernel)), width_(width) {}

  [[nodiscard]] std::string name() const override {
    return "OpenCL (" + on_.name + ", " + std::to_string(on_.device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()) +
           " compute units, " + std::to_string(width_) + " points a work-item)";
  }

 private:
  [[nodiscard]] Result<void> compute_shares(FieldBatch& batch) override {
    if (const cl_int code = upload(batch); code != CL_SUCCESS)
      return opencl_failure(code, "copying points to " + on_.name);
    if (const cl_int code = launch(static_cast<u32>(batch.tasks.size())); code != CL_SUCCESS)
      return opencl_failure(code, "running the field kernel on " + on_.name);
    const cl_int code = on_.queue.enqueueReadBuffer(share_.buffer(), CL_TRUE, 0, batch.share.size() * sizeof(float),
                                                    batch.share.data());
    if (code != CL_SUCCESS) return opencl_failure(code, "reading the field from " + on_.name);
    return {};
  }

  cl_int upload(const FieldBatch& batch) {
    const cl_int codes[] = {cells_.upload(on_, batch.cells.cells()),
                            faces_.upload(on_, batch.cells.faces()),
                            runs_.upload(on_, batch.cells.runs()),
                            edges_.upload(on_, batch.cells.edges()),
                            tasks_.upload(on_, batch.tasks),
                            x_.upload(on_, batch.x),
                            y_.upload(on_, batch.y),
                            z_.upload(on_, batch.z),
                            share_.reserve(on_.context, batch.share.size() * sizeof(float))};
    return *std::min_element(std::begin(codes), std::end(codes));  // errors are negative, success is 0
  }

  cl_int launch(u32 task_count) {
    cl_uint argument = 0;
    cl_int code = CL_SUCCESS;
    const auto set = [&](const auto& value) { code = std::min(code, kernel_.setArg(argument++, value)); };
    for (const DeviceArray* array : {&cells_, &faces_, &runs_, &edges_, &tasks_}) set(array->buffer());
    set(task_count);
    for (const DeviceArray* array : {&x_, &y_, &z_, &share_}) set(array->buffer());
    if (code != CL_SUCCESS) return code;
    const std::size_t items = std::size_t{task_count} * (SONOLOFT_LANES / width_);
    const std::size_t group = width_ == 1 ? 64 : 16;  // one size each: every other is compiled anew
    return on_.queue.enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange((items + group - 1) / group * group),
                                          cl::NDRange(group));
  }

  OpenClDevice on_;
  cl::Kernel kernel_;
  u32 width_;
  DeviceArray cells_, faces_, runs_, edges_, tasks_, x_, y_, z_, share_;
};

/// Points per work-item: a divisor of SONOLOFT_LANES.
u32 vector_width(const OpenClDevice& on, KernelForm form) {
  if (form == KernelForm::scalar || !on.is_processor) return 1;
  const cl_uint native = on.device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>();
  return native >= 16 ? 16 : native >= 8 ? 8 : 4;
}

/// One cell, a cube with the top labelled 1 and the bottom unknown, and points of it.
FieldBatch cube_batch() {
  std::vector<Eigen::Isometry3d> frames(6, Eigen::Isometry3d::Identity());
  std::vector<FacePolygon> polygons(6);
  std::vector<CellFace> faces;
  for (u32 i = 0; i < 6; ++i) {
    const Label label = i == 4 ? Label{1} : i == 5 ? kUnknown : kOutside;
    const Eigen::Vector3d outward = (i % 2 == 0 ? 1 : -1) * Eigen::Vector3d::Unit(static_cast<int>(i / 2));
    frames[i].linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), outward).toRotationMatrix();
    frames[i].translation() = outward;
    const Eigen::Vector2d corners[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (u32 k = 0; k < 4; ++k) polygons[i].push_back({corners[k], corners[(k + 1) % 4], label, kBeyondFace});
    faces.push_back({&frames[i], PlaneId{i}, false, label, &polygons[i]});
  }
  FieldBatch batch;
  const std::uint32_t cell = batch.cells.add(faces, Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 64; ++i) points.emplace_back(std::sin(i), std::sin(2.1 * i), std::sin(0.7 * i + 1));
  batch.add_points(cell, points);
  return batch;
}

/// A driver that computes nonsense must not draw anatomy: compares with the CPU twin. Compiles what is compiled late.
Result<void> check_device(FieldEvaluator& evaluator) {
  FieldBatch batch = cube_batch(), expected = batch;
  if (const auto done = evaluator.evaluate(batch); !done) return done;
  if (const auto done = make_cpu_evaluator(1)->evaluate(expected); !done) return done;
  for (std::size_t i = 0; i < batch.share.size(); ++i)
    if (!(std::abs(batch.share[i] - expected.share[i]) < 1e-3f))
      return fail(ErrorCode::opencl_failed,
                  evaluator.name() + " computes wrong values; update the driver or choose the device 'cpu'");
  return {};
}

}  // namespace

Result<std::unique_ptr<FieldEvaluator>> make_opencl_evaluator(int threads, KernelForm form) {
  auto device = open_opencl_device(threads);
  if (!device) return tl::unexpected(device.error());
  const u32 width = vector_width(*device, form);
  const auto program =
      build_program(*device, kFieldKernelSource, "-cl-std=CL1.2 -DSONOLOFT_WIDTH=" + std::to_string(width));
  if (!program) return tl::unexpected(program.error());
  cl_int code = CL_SUCCESS;
  cl::Kernel kernel(*program, "field_shares", &code);
  if (code != CL_SUCCESS) return opencl_failure(code, "making the field kernel on " + device->name);
  std::unique_ptr<FieldEvaluator> evaluator =
      std::make_unique<OpenClEvaluator>(std::move(*device), std::move(kernel), width);
  if (const auto sound = check_device(*evaluator); !sound) return tl::unexpected(sound.error());
  return evaluator;
}

}  // namespace sonoloft
