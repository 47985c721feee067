#include "core/reconstructor/reconstructor.h"

#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <numeric>

#include "core/cells/cell_complex.h"
#include "core/gpu/make_evaluator.h"
#include "core/mesh/surface_extractor.h"
#include "core/octree/sample_octree.h"
#include "core/slice/section.h"

namespace sonoloft {
namespace {

using Clock = std::chrono::steady_clock;

/// Slices that pass nearer than this share of the spacing cannot both be told apart in the mesh.
constexpr double kMergeGap = 0.25;
/// What one sample of the coarse detail stands for, in each axis.
constexpr double kCoarseSpacings = 2;
/// Chunk keys hold 2^18 lattice points to either side.
constexpr double kMaxLatticePoints = 1 << 18;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Result<void> check(const ReconstructorOptions& o) {
  if (o.box.isEmpty() || !o.box.min().allFinite() || !o.box.max().allFinite() || o.box.sizes().minCoeff() <= 0.0)
    return fail(ErrorCode::invalid_argument, "the box of the scan is empty or not finite: give its two corners in mm");
  if (!(o.spacing_mm > 0.0) || !std::isfinite(o.spacing_mm))
    return fail(ErrorCode::invalid_argument, "the spacing must be a positive number of mm");
  if (o.box.sizes().maxCoeff() / o.spacing_mm > kMaxLatticePoints)
    return fail(ErrorCode::invalid_argument,
                "the box is more than 2^18 spacings long: use a wider spacing or a smaller box");
  if (o.threads < 1) return fail(ErrorCode::invalid_argument, "threads must be at least 1");
  return {};
}

/// The samples and the mesh of one detail. All details share the cells.
struct Level {
  Level(const ReconstructorOptions& options, double spacings)
      : octree(options.box.min(), spacings * options.spacing_mm) {}

  SampleOctree octree;
  SurfaceExtractor surface;
};

}  // namespace

struct Reconstructor::State {
  State(const ReconstructorOptions& o, std::unique_ptr<FieldEvaluator> field)
      : options(o),
        evaluator(std::move(field)),
        cells(o.box, kMergeGap * o.spacing_mm),
        levels{Level(o, 1), Level(o, kCoarseSpacings)} {}

  ReconstructorOptions options;
  std::unique_ptr<FieldEvaluator> evaluator;
  CellComplex cells;
  std::array<Level, 2> levels;  ///< [Detail]
  Detail shown = Detail::full;  ///< by the last update()

  [[nodiscard]] Level& level(Detail detail) { return levels[static_cast<std::size_t>(detail)]; }
};

Result<ReconstructorOptions> options_for(std::span<const TrackedSlice> slices, int depth) {
  assert(depth >= 2 && depth <= 12);
  Eigen::AlignedBox3d extent;
  for (const TrackedSlice& slice : slices)
    for (const Contour& contour : slice.contours)
      for (std::uint32_t i = 0; i < contour.count; ++i) {
        const Eigen::Vector2d& p = slice.points[contour.first + i];
        extent.extend(slice.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0.0));
      }
  if (extent.isEmpty() || extent.sizes().maxCoeff() <= 0.0)
    return fail(ErrorCode::empty_input, "no slice has a contour: there is nothing to reconstruct");
  const double longest = extent.sizes().maxCoeff();
  ReconstructorOptions options;
  options.box = {extent.min() - Eigen::Vector3d::Constant(longest), extent.max() + Eigen::Vector3d::Constant(longest)};
  options.spacing_mm = 1.1 * longest / std::exp2(depth);
  return options;
}

Reconstructor::Reconstructor(std::unique_ptr<State> state) : state_(std::move(state)) {}
Reconstructor::~Reconstructor() = default;
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;

Result<Reconstructor> Reconstructor::create(const ReconstructorOptions& options) {
  if (auto valid = check(options); !valid) return tl::unexpected<Error>(valid.error());
  auto evaluator = make_evaluator(options.device, options.threads, options.log);
  if (!evaluator) return tl::unexpected<Error>(evaluator.error());
  return Reconstructor(std::make_unique<State>(options, std::move(*evaluator)));
}

Result<InsertReport> Reconstructor::add(const TrackedSlice& slice) {
  const auto start = Clock::now();
  const auto section = make_section(slice);
  if (!section) return tl::unexpected<Error>(section.error());
  InsertReport report;
  report.repaired_crossings = section->repaired_crossings;
  const auto delta = state_->cells.insert(*section);
  if (delta) {
    for (Level& level : state_->levels) level.octree.note(state_->cells, *delta);
    report.cells_reached = delta->reached;
    report.cells_cut = static_cast<std::uint32_t>(delta->lower.size());
    report.nodes_visited = delta->work.nodes_visited;
    report.faces_cut = delta->work.faces_cut;
    report.edges_clipped = delta->work.edges_clipped;
  } else if (delta.error().code == ErrorCode::duplicate_plane) {
    report.outcome = SliceOutcome::merged;
  } else {
    return tl::unexpected<Error>(delta.error());
  }
  report.cells_ms = ms_since(start);
  return report;
}

Result<UpdateReport> Reconstructor::update(Detail detail) {
  Level& level = state_->level(detail);
  state_->shown = detail;
  auto change = level.octree.update(state_->cells, *state_->evaluator, state_->options.threads);
  if (!change) return tl::unexpected<Error>(change.error());
  UpdateReport report;
  report.samples_evaluated = change->evaluated;
  report.edge_evaluations = change->edge_evaluations;
  report.bricks_smoothed = change->smoothed_bricks;
  report.field_ms = change->field_ms;
  report.octree_ms = change->octree_ms;
  report.smooth_ms = change->smooth_ms;
  const auto start = Clock::now();
  report.changed_chunks = level.surface.update(level.octree, change->bricks, state_->options.threads);
  report.chunks_rebuilt = level.surface.chunks_rebuilt();
  report.mesh_ms = ms_since(start);
  return report;
}

MeshSnapshot Reconstructor::mesh() const {
  return state_->level(state_->shown).surface.snapshot();
}

const SampleLattice& Reconstructor::samples() const {
  return state_->level(state_->shown).octree;
}

ReconstructorCounts Reconstructor::counts() const {
  ReconstructorCounts counts;
  counts.cells = state_->cells.cell_count();
  counts.faces = state_->cells.face_count();
  counts.edges = state_->cells.edge_count();
  const Level& level = state_->level(state_->shown);
  counts.samples = level.octree.sample_count();
  counts.leaves = level.surface.counters().leaves;
  for (const auto& chunk : mesh().chunks) counts.triangles += chunk->triangles.size();
  return counts;
}

std::string Reconstructor::device_name() const {
  return state_->evaluator->name();
}

}  // namespace sonoloft
