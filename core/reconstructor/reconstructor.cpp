#include "core/reconstructor/reconstructor.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/background/background.h"
#include "core/background/rim.h"
#include "core/cells/cell_complex.h"
#include "core/completion/published_completion.h"
#include "core/gpu/make_evaluator.h"
#include "core/mesh/surface_extractor.h"
#include "core/octree/sample_octree.h"
#include "core/reconstructor/cell_admission.h"
#include "core/slice/section.h"
#include "core/slopes/contour_slopes.h"

namespace sonoloft {
namespace {

using Clock = std::chrono::steady_clock;

/// Slices that pass nearer than this share of the spacing cannot both be told apart in the mesh.
constexpr double kMergeGap = 0.25;
/// Spacing of the next coarser detail over that of a detail.
constexpr double kCoarser = 2;
static_assert(kOverNextCoarser == kCoarser * kCoarser, "samples lie at surfaces");

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool has_unknown_part(const Section& section) {
  return section.border == kUnknown ||
         std::any_of(section.edges.begin(), section.edges.end(),
                     [](const SectionEdge& e) { return e.left == kUnknown || e.right == kUnknown; });
}

/// The samples and the mesh of one detail. All details share the cells.
struct Level {
  Level(const ReconstructorOptions& options, double spacings)
      : octree(options.box.min(), spacings * options.spacing_mm) {}

  SampleOctree octree;
  SurfaceExtractor surface;
  std::vector<CellId> unsettled;  ///< ascending: sampled with slopes that are no more
  double drawn = 0;               ///< State::drawn_in_full() when it was brought up to date
};

void sort_unique(std::vector<CellId>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace

struct Reconstructor::State {
  State(const ReconstructorOptions& o, std::unique_ptr<FieldEvaluator> field)
      : options(o),
        evaluator(std::move(field)),
        cells(o.box, kMergeGap * o.spacing_mm),
        levels{Level(o, 1), Level(o, kCoarser), Level(o, kCoarser * kCoarser)} {
    if (o.field == FieldMethod::smooth) slopes.emplace(o.background_mm);
  }

  ReconstructorOptions options;
  std::unique_ptr<FieldEvaluator> evaluator;
  CellComplex cells;
  CellAdmission admission;
  std::optional<ContourSlopes> slopes;   ///< of FieldMethod::smooth
  std::vector<CellId> cut;               ///< since slopes were brought up to date: these are sampled anew anyway
  std::vector<std::uint64_t> slice_ids;  ///< [SliceId] TrackedSlice::id; of caps: meaningless
  std::vector<SliceId> caps;             ///< held at the ends of a stack, after all other slices
  bool caps_due = false;                 ///< slices came or went since
  std::optional<Background> background;  ///< once there is a need
  std::map<SliceId, Rim> rims;           ///< of the slices held, once there is a background
  std::optional<PublishedCompletion> completion;
  bool completion_due = false;
  std::array<Level, kDetails> levels;  ///< [Detail]
  Detail shown = Detail::full;         ///< by the last update()

  [[nodiscard]] bool news_only() const { return options.admission == Admission::news; }

  /// Slices that show everything everywhere leave nothing for a background to fill.
  void make_background() {
    background.emplace(options.box, options.background_mm);
    for (const SliceId slice : slices()) add_to_background(slice);
  }

  void add_to_background(SliceId slice) {
    background->add(cells.section(slice));
    rims.emplace(slice, Rim(cells.section(slice), options.background_mm));
  }

  void note(const CellComplex::Delta& delta) {
    admission.forget(delta.divided);
    for (Level& l : levels) l.octree.note(cells, delta);
    if (!slopes) return;
    slopes->note(delta);
    for (const auto* cells_cut : {&delta.divided, &delta.upper})
      cut.insert(cut.end(), cells_cut->begin(), cells_cut->end());
  }

  /// What was added and not withdrawn, ascending.
  [[nodiscard]] std::vector<SliceId> slices() const {
    std::vector<SliceId> held = cells.slices();
    std::erase_if(held, [&](SliceId slice) { return std::ranges::find(caps, slice) != caps.end(); });
    return held;
  }

  CellComplex::Withdrawal take_back(SliceId slice) {
    CellComplex::Withdrawal withdrawal = cells.withdraw(slice);
    admission.forget(withdrawal.removed);
    for (Level& l : levels) l.octree.note(cells, withdrawal);
    if (slopes) slopes->note(slice, withdrawal);
    return withdrawal;
  }

  /// Slices come and go as if caps had never been there.
  void lift_caps() {
    for (; !caps.empty(); caps.pop_back()) take_back(caps.back());
    caps_due = options.caps != Caps::box;
  }

  /// Caps say nothing of what was seen: they cut cells, and are not in the background.
  void place_caps() {
    if (!std::exchange(caps_due, false)) return;
    std::vector<Eigen::Isometry3d> frames;
    for (const SliceId slice : slices()) frames.push_back(cells.section(slice).image_to_reference);
    for (const Eigen::Isometry3d& frame :
         stack_caps(frames, options.caps == Caps::gap ? 1 : 0, 0.5 * options.spacing_mm)) {
      Section empty;
      empty.image_to_reference = frame;
      const auto delta = cells.insert(std::move(empty));
      if (!delta) continue;  // outside of the box, which ends the object there itself
      note(*delta);
      caps.push_back(delta->slice);
      slice_ids.push_back(0);
    }
  }

  void update_slopes() {
    std::vector<CellId> changed = slopes->update(cells, options.threads);
    sort_unique(cut);
    std::erase_if(changed, [&](CellId cell) { return std::binary_search(cut.begin(), cut.end(), cell); });
    cut.clear();
    for (Level& l : levels) {
      l.unsettled.insert(l.unsettled.end(), changed.begin(), changed.end());
      sort_unique(l.unsettled);
    }
  }

  void complete() {
    completion.emplace(cells, options.hops, options.background_mm, options.threads);
    completion_due = false;
    for (Level& l : levels) l.octree.note(completion->cells());
  }
  [[nodiscard]] UnmeasuredFill fill() const {
    if (completion)
      return {[this](CellId cell, std::span<const Eigen::Vector3d> points, PointShares& out) {
                completion->shares(cell, points, out);
              },
              {}};
    if (background)
      return {[this](CellId, std::span<const Eigen::Vector3d> points, PointShares& out) {
                background->shares(points, out);
              },
              [this](SliceId slice) -> const Rim& { return rims.at(slice); }};
    return {};
  }

  [[nodiscard]] Result<CellAdmission::Widths> judge(const Section& section) {
    return news_only() ? admission.judge(section, cells, *background, *evaluator, options.threads)
                       : CellAdmission::Widths{};
  }
  [[nodiscard]] double width_mm(const CellAdmission::Widths& widths, CellId cell) const {
    if (!news_only()) return 0;
    const auto it = widths.find(cell);
    return it == widths.end() ? std::numeric_limits<double>::infinity() : it->second;
  }
  /// Samples in full detail of the surfaces that are drawn in any: a detail that waits for its turn lacks some of them.
  [[nodiscard]] double drawn_in_full() const {
    double most = 0, in_full = 1;
    for (const Level& l : levels) {
      most = std::max(most, in_full * static_cast<double>(l.octree.sample_count()));
      in_full *= kOverNextCoarser;
    }
    return most;
  }
  [[nodiscard]] Level& level(Detail detail) { return levels[static_cast<std::size_t>(detail)]; }
};

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
  State& s = *state_;
  auto section = make_section(slice);
  if (!section) return tl::unexpected<Error>(section.error());
  InsertReport report;
  report.repaired_crossings = section->repaired_crossings;
  if (!s.background && (s.news_only() || has_unknown_part(*section))) s.make_background();
  s.lift_caps();
  const auto widths = s.judge(*section);
  if (!widths) return tl::unexpected<Error>(widths.error());
  const auto delta = s.cells.insert(std::move(*section), [&](CellId cell) { return s.width_mm(*widths, cell); });
  if (!delta) return tl::unexpected<Error>(delta.error());
  s.note(*delta);
  if (s.background) s.add_to_background(delta->slice);
  s.completion_due = s.options.completion == Completion::published;
  s.slice_ids.push_back(slice.id);
  report.cells_reached = delta->reached;
  report.cells_cut = static_cast<std::uint32_t>(delta->lower.size());
  report.nodes_visited = delta->work.nodes_visited;
  report.faces_cut = delta->work.faces_cut;
  report.edges_clipped = delta->work.edges_clipped;
  report.outcome = !delta->lower.empty()  ? SliceOutcome::inserted
                   : delta->too_thin == 0 ? SliceOutcome::explained
                                          : SliceOutcome::merged;
  report.cells_ms = ms_since(start);
  return report;
}

Result<void> Reconstructor::withdraw(std::uint64_t id) {
  State& s = *state_;
  const std::vector<SliceId> held = s.slices();
  const auto found = std::find_if(held.rbegin(), held.rend(),
                                  [&](SliceId slice) { return s.slice_ids[static_cast<std::uint32_t>(slice)] == id; });
  if (found == held.rend())
    return fail(ErrorCode::invalid_argument,
                "no slice " + std::to_string(id) + " is held: it was refused, or withdrawn before");
  if (s.background) {
    s.background->remove(s.cells.section(*found));
    s.rims.erase(*found);
  }
  s.completion_due = s.options.completion == Completion::published;
  s.lift_caps();
  const CellComplex::Withdrawal withdrawal = s.take_back(*found);
  for (const SliceId slice : held) {
    if (slice == *found) continue;
    Result<CellAdmission::Widths> widths;  // of the few slices that get there
    bool judged = false;
    const CellComplex::Delta delta = s.cells.insert_again(slice, withdrawal, [&](CellId cell) {
      if (!std::exchange(judged, true)) widths = s.judge(s.cells.section(slice));
      return widths ? s.width_mm(*widths, cell) : 0.0;
    });
    if (!widths) return tl::unexpected<Error>(widths.error());
    s.note(delta);
  }
  return {};
}

Result<UpdateReport> Reconstructor::update(Detail detail, Slopes slopes) {
  State& s = *state_;
  UpdateReport report;
  const auto begin = Clock::now();
  s.place_caps();
  report.cells_ms = ms_since(begin);
  if (s.background) {
    const auto start = Clock::now();
    const auto changes = s.background->update(s.options.threads);
    for (Level& level : s.levels) level.octree.note(*s.background, changes);
    if (s.completion_due) s.complete();
    report.background_ms = ms_since(start);
  }
  Level& level = s.level(detail);
  s.shown = detail;
  if (s.slopes) {
    const auto start = Clock::now();
    s.update_slopes();
    if (slopes == Slopes::settled) level.octree.note(std::exchange(level.unsettled, {}));
    report.slopes_ms = ms_since(start);
  }
  report.unsettled_cells = level.unsettled.size();
  auto change =
      level.octree.update(s.cells, s.slopes ? &*s.slopes : nullptr, *s.evaluator, s.fill(), s.options.threads);
  if (!change) return tl::unexpected<Error>(change.error());
  level.drawn = s.drawn_in_full();
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

std::array<std::size_t, kDetails> Reconstructor::samples_due() const {
  const double drawn = state_->drawn_in_full();
  std::array<std::size_t, kDetails> due{};
  double in_full = 1;
  for (std::size_t d = 0; d < kDetails; ++d, in_full *= kOverNextCoarser) {
    const Level& level = state_->levels[d];
    due[d] = level.octree.stale_count() + static_cast<std::size_t>(std::max(drawn - level.drawn, 0.0) / in_full);
  }
  return due;
}

MeshSnapshot Reconstructor::mesh() const {
  return state_->level(state_->shown).surface.snapshot();
}

const SampleLattice& Reconstructor::samples() const {
  return state_->level(state_->shown).octree;
}

Confidence Reconstructor::confidence(std::span<const Eigen::Vector3f> points_mm) {
  if (!state_->background) state_->make_background();
  return confidence_at(points_mm, samples(), *state_->background);
}

Coverage Reconstructor::coverage() {
  State& s = *state_;
  if (!s.background) s.make_background();
  std::vector<const Section*> sections;
  for (const SliceId slice : s.slices()) sections.push_back(&s.cells.section(slice));
  return coverage_of(sections, *s.background);
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
