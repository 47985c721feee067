#include "core/gpu/opencl_evaluator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/gpu/opencl_device.h"

namespace sonoloft {

extern const char kFieldKernelSource[];  // core/kernels/field.cl, embedded by the build

namespace {

using kernels::u32;

constexpr std::size_t kLanes = SONOLOFT_LANES;
constexpr cl_uint kFirstTaskArgument = 7;  ///< of the kernel; then the last task
/// Enough to keep a graphics device busy, little enough to be copied while another such piece is computed.
constexpr std::size_t kTasksPerPiece = 4096;

template <class Range>
std::size_t bytes_of(const Range& values) {
  return values.size() * sizeof(*values.data());
}

/// Whole blocks of a batch: their tasks, points and shares lie in a row.
struct Piece {
  std::size_t first_task, last_task;
  std::size_t first_share, last_share;
};

/// @pre the batch has blocks
std::vector<Piece> cut(const FieldBatch& batch) {
  std::vector<Piece> pieces;
  for (const FieldBlock& block : batch.blocks) {
    const std::size_t task = block.first_point / kLanes;
    if (pieces.empty() || task - pieces.back().first_task >= kTasksPerPiece) {
      if (!pieces.empty()) pieces.back().last_task = task, pieces.back().last_share = block.first_share;
      pieces.push_back({task, batch.tasks.size(), block.first_share, batch.share_count});
    }
  }
  return pieces;
}

/// A buffer on the device that grows when it must.
class DeviceArray {
 public:
  /// Room for `bytes`; what was in it is gone when it grows.
  cl_int reserve(const cl::Context& context, std::size_t bytes) {
    bytes = std::max(bytes, kLeastBytes);
    if (bytes <= capacity_) return CL_SUCCESS;
    cl_int code = CL_SUCCESS;
    const std::size_t wanted = bytes + bytes / 2;
    buffer_ = cl::Buffer(context, CL_MEM_READ_WRITE, wanted, nullptr, &code);
    capacity_ = code == CL_SUCCESS ? wanted : 0;
    return code;
  }

  [[nodiscard]] const cl::Buffer& buffer() const { return buffer_; }

 private:
  static constexpr std::size_t kLeastBytes = 16;  // a buffer of no bytes is an error

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
    cl_int code = run(batch);
    // Also after an error: the queues must be done with the batch.
    for (const cl::CommandQueue* queue : {&on_.copies, &on_.kernels}) code = std::min(code, queue->finish());
    if (code != CL_SUCCESS) return opencl_failure(code, "evaluating the field on " + on_.name);
    return {};
  }

  /// While a piece is computed, the shares of the one before it come back and the points of the next go there.
  cl_int run(FieldBatch& batch) {
    const std::vector<Piece> pieces = cut(batch);
    std::vector<cl::Event> computed(pieces.size());
    cl_int code = upload_cells(batch);
    for (std::size_t i = 0; i < pieces.size() && code == CL_SUCCESS; ++i) {
      std::vector<cl::Event> uploaded(1);
      code = upload_points(batch, pieces[i], uploaded.front());
      if (code == CL_SUCCESS) code = launch(pieces[i], uploaded, computed[i]);
      if (code == CL_SUCCESS && i > 0) code = download(batch, pieces[i - 1], {computed[i - 1]});
    }
    if (code == CL_SUCCESS) code = download(batch, pieces.back(), {computed.back()});
    return code;
  }

  cl_int upload_cells(const FieldBatch& batch) {
    const auto upload = [this](DeviceArray& array, const auto& values) {
      const cl_int code = array.reserve(on_.context, bytes_of(values));
      return code != CL_SUCCESS ? code : write(array, values, 0, values.size(), nullptr);
    };
    cl_int code = std::min({upload(cells_, batch.cells.cells()), upload(faces_, batch.cells.faces()),
                            upload(runs_, batch.cells.runs()), upload(edges_, batch.cells.edges()),
                            upload(vertices_, batch.cells.vertices()), upload(stretches_, batch.cells.stretches())});
    code =
        std::min({code, tasks_.reserve(on_.context, bytes_of(batch.tasks)), x_.reserve(on_.context, bytes_of(batch.x)),
                  y_.reserve(on_.context, bytes_of(batch.y)), z_.reserve(on_.context, bytes_of(batch.z)),
                  weight_.reserve(on_.context, sizeof(float) * batch.weight_count),
                  share_.reserve(on_.context, bytes_of(batch.share))});
    cl_uint argument = 0;
    const auto set = [&](const auto& value) { code = std::min(code, kernel_.setArg(argument++, value)); };
    for (const DeviceArray* array : {&cells_, &faces_, &runs_, &edges_, &vertices_, &stretches_, &tasks_})
      set(array->buffer());
    argument = kFirstTaskArgument + 2;
    for (const DeviceArray* array : {&x_, &y_, &z_, &weight_, &share_}) set(array->buffer());
    return code;  // errors are negative, success is 0
  }

  cl_int upload_points(const FieldBatch& batch, const Piece& piece, cl::Event& done) {
    const std::size_t first = piece.first_task * kLanes, last = piece.last_task * kLanes;
    const cl_int code = std::min({write(tasks_, batch.tasks, piece.first_task, piece.last_task, nullptr),
                                  write(x_, batch.x, first, last, nullptr), write(y_, batch.y, first, last, nullptr),
                                  write(z_, batch.z, first, last, &done)});
    return std::min(code, on_.copies.flush());
  }

  cl_int launch(const Piece& piece, const std::vector<cl::Event>& after, cl::Event& done) {
    cl_int code = std::min(kernel_.setArg(kFirstTaskArgument, static_cast<u32>(piece.first_task)),
                           kernel_.setArg(kFirstTaskArgument + 1, static_cast<u32>(piece.last_task)));
    if (code != CL_SUCCESS) return code;
    const std::size_t items = (piece.last_task - piece.first_task) * (kLanes / width_);
    const std::size_t group = width_ == 1 ? 64 : 16;  // one size each: every other is compiled anew
    code = on_.kernels.enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange((items + group - 1) / group * group),
                                            cl::NDRange(group), &after, &done);
    return std::min(code, on_.kernels.flush());
  }

  cl_int download(FieldBatch& batch, const Piece& piece, const std::vector<cl::Event>& after) {
    const std::size_t bytes = (piece.last_share - piece.first_share) * sizeof(float);
    return on_.copies.enqueueReadBuffer(share_.buffer(), CL_FALSE, piece.first_share * sizeof(float), bytes,
                                        batch.share.data() + piece.first_share, &after);
  }

  template <class Range>
  cl_int write(const DeviceArray& to, const Range& values, std::size_t first, std::size_t last, cl::Event* done) {
    constexpr std::size_t kSize = sizeof(*values.data());
    if (first == last) return CL_SUCCESS;  // copying nothing is an error
    return on_.copies.enqueueWriteBuffer(to.buffer(), CL_FALSE, first * kSize, (last - first) * kSize,
                                         values.data() + first, nullptr, done);
  }

  OpenClDevice on_;
  cl::Kernel kernel_;
  u32 width_;
  DeviceArray cells_, faces_, runs_, edges_, vertices_, stretches_, tasks_, x_, y_, z_, weight_, share_;
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

Result<std::unique_ptr<FieldEvaluator>> make_opencl_evaluator(int threads, KernelForm form, DeviceKinds kinds) {
  auto device = open_opencl_device(threads, kinds);
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
