#include "core/gpu/opencl_device.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/gpu/program_cache.h"

namespace sonoloft {
namespace {

bool usable(const cl::Device& device) {
  int major = 0, minor = 0;
  if (std::sscanf(device.getInfo<CL_DEVICE_VERSION>().c_str(), "OpenCL %d.%d", &major, &minor) != 2) return false;
  return major * 10 + minor >= 12 && device.getInfo<CL_DEVICE_AVAILABLE>() &&
         device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>();
}

bool is_processor(const cl::Device& device) {
  return (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
}

std::vector<cl::Device> usable_devices() {
  std::vector<cl::Platform> platforms;
  cl::Platform::get(&platforms);
  std::vector<cl::Device> found;
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> devices;
    platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
    std::copy_if(devices.begin(), devices.end(), std::back_inserter(found), usable);
  }
  return found;
}

/// The part of a processor that has `threads` cores; all of it where it cannot be divided. Parts are kept for good:
/// PoCL 3.1 crashes when one is released while its thread puts the last command away, after finish() has returned.
cl::Device with_threads(const cl::Device& device, int threads) {
  if (static_cast<cl_uint>(threads) >= device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()) return device;
  static std::mutex mutex;
  static auto& parts = *new std::map<std::pair<cl_device_id, int>, cl::Device>;
  const std::lock_guard lock(mutex);
  cl::Device& part = parts[{device(), threads}];
  if (part() != nullptr) return part;
  const cl_device_partition_property by_counts[] = {CL_DEVICE_PARTITION_BY_COUNTS, threads,
                                                    CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
  std::vector<cl::Device> made;
  cl::Device whole = device;
  const bool divided = whole.createSubDevices(by_counts, &made) == CL_SUCCESS && !made.empty();
  return part = divided ? made.front() : device;
}

std::string first_line(std::string text) {
  text.erase(0, text.find_first_not_of(" \t\r\n"));
  return text.substr(0, text.find('\n'));
}

}  // namespace

Result<OpenClDevice> open_opencl_device(int threads, DeviceKinds kinds) {
  const std::vector<cl::Device> devices = usable_devices();
  if (devices.empty())
    return fail(
        ErrorCode::no_opencl_device,
        "no OpenCL 1.2 device found; install a driver (for the processor: pocl-opencl-icd) or choose the device 'cpu'");
  const auto graphics = std::find_if_not(devices.begin(), devices.end(), is_processor);
  if (graphics == devices.end() && kinds == DeviceKinds::no_processors)
    return fail(ErrorCode::no_opencl_device,
                "no OpenCL graphics device or accelerator found; on a processor (" +
                    devices.front().getInfo<CL_DEVICE_NAME>() +
                    ") the device 'cpu' is faster than OpenCL; to use it all the same choose the device 'opencl'");

  OpenClDevice opened;
  opened.device = graphics != devices.end() ? *graphics : devices.front();
  opened.name = opened.device.getInfo<CL_DEVICE_NAME>();
  opened.is_processor = is_processor(opened.device);
  if (opened.is_processor) opened.device = with_threads(opened.device, threads);
  cl_int code = CL_SUCCESS;
  opened.context = cl::Context(opened.device, nullptr, nullptr, nullptr, &code);
  if (code != CL_SUCCESS) return opencl_failure(code, "opening " + opened.name);
  for (cl::CommandQueue* queue : {&opened.copies, &opened.kernels}) {
    *queue = cl::CommandQueue(opened.context, opened.device, 0, &code);
    if (code != CL_SUCCESS) return opencl_failure(code, "opening a queue on " + opened.name);
  }
  return opened;
}

Result<cl::Program> build_program(const OpenClDevice& device, const std::string& source, const std::string& options) {
  const std::string key = device.name + '\n' + device.device.getInfo<CL_DEVICE_VENDOR>() + '\n' +
                          device.device.getInfo<CL_DEVICE_VERSION>() + '\n' +
                          device.device.getInfo<CL_DRIVER_VERSION>() + '\n' + options + '\n' + source;
  if (const std::vector<unsigned char> binary = read_cached_program(key); !binary.empty()) {
    cl::Program program(device.context, {device.device}, cl::Program::Binaries{binary});
    if (program.build(device.device, options.c_str()) == CL_SUCCESS) return program;
  }

  cl::Program program(device.context, source);
  const cl_int code = program.build(device.device, options.c_str());
  if (code != CL_SUCCESS) {
    const std::string log = first_line(program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device.device));
    return opencl_failure(code, "building a kernel for " + device.name + " (" + log + ")");
  }
  const cl::Program::Binaries binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (binaries.size() == 1) write_cached_program(key, binaries.front());
  return program;
}

}  // namespace sonoloft
