#pragma once
// slice -> cells -> field -> octree -> mesh -> callback: all five stages, joined
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/coverage/confidence.h"
#include "core/coverage/coverage.h"
#include "core/mesh/mesh.h"
#include "core/reconstructor/reconstructor_options.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// What became of one slice.
enum class SliceOutcome : std::uint8_t {
  inserted,   ///< it cut cells: the mesh may have changed
  explained,  ///< it says what is known already, and cut nothing
  merged,     ///< it says something new, but lies too near to earlier slices to cut: it counts in the background only
};

struct InsertReport {
  SliceOutcome outcome = SliceOutcome::inserted;
  std::uint32_t cells_reached = 0;
  std::uint32_t cells_cut = 0;
  std::uint32_t nodes_visited = 0;       ///< of the tree of planes, on the way to those cells
  std::uint32_t faces_cut = 0;           ///< walls that the cut crosses
  std::uint32_t edges_clipped = 0;       ///< contour and outline pieces of the slice on its way, and of those walls
  std::uint32_t repaired_crossings = 0;  ///< of contours
  double cells_ms = 0;                   ///< admission and cutting
};

/// How finely the mesh is drawn.
enum class Detail : std::uint8_t {
  full,    ///< at the spacing of the options
  coarse,  ///< at twice that spacing, a quarter of the samples: while slices come faster than full detail allows
  draft,   ///< at four times that spacing: while they come faster than coarse detail allows
};
inline constexpr std::size_t kDetails = 3;
/// Surface samples and triangles of a detail over those of the next coarser one, about.
inline constexpr int kOverNextCoarser = 4;

/// Whether an update() follows the slopes that a slice changed in cells that it did not cut. It matters to
/// FieldMethod::smooth only.
enum class Slopes : std::uint8_t {
  settled,    ///< everywhere: the mesh that all slices together give
  streaming,  ///< not there, while slices come fast: the mesh is closed and passes through all slices, and bends a
              ///< little more at some of them until the next settled update
};

/// What one update() did.
struct UpdateReport {
  std::vector<BrickCoord> changed_chunks;  ///< against the mesh of the same detail before: chunks that changed,
                                           ///< appeared or vanished; ascending
  std::size_t unsettled_cells = 0;         ///< that wait for a settled update of this detail
  std::size_t samples_evaluated = 0;
  std::size_t edge_evaluations = 0;  ///< edges of cells times samples; far ones are summed together
  std::size_t bricks_smoothed = 0;
  std::size_t chunks_rebuilt = 0;
  double cells_ms = 0;       ///< cutting at the ends of a stack
  double background_ms = 0;  ///< and of the published completion
  double slopes_ms = 0;
  double field_ms = 0, octree_ms = 0, smooth_ms = 0, mesh_ms = 0;

  /// What goes with the samples taken.
  [[nodiscard]] double sampling_ms() const { return field_ms + octree_ms + smooth_ms + mesh_ms; }
};

/// Size of the reconstruction now.
struct ReconstructorCounts {
  std::size_t cells = 0, faces = 0, edges = 0;  ///< convex cells, walls, label borders and outline pieces on them
  std::size_t samples = 0, leaves = 0, triangles = 0;
};

/// Slices in, closed multi-label surfaces out, each slice at the cost of what it changes. Frame: reference, mm.
/// A settled mesh of either detail depends on the slices and their order, not on how many were added between two
/// updates, nor on the kind of these, nor on the number of threads: to the last byte.
/// Threads: one writer; const members may run together, but not during add() or update().
class Reconstructor {
 public:
  /// @error invalid_argument, no_opencl_device, opencl_failed
  [[nodiscard]] static Result<Reconstructor> create(const ReconstructorOptions& options);
  ~Reconstructor();
  Reconstructor(Reconstructor&&) noexcept;
  Reconstructor& operator=(Reconstructor&&) noexcept;

  /// Cuts the cells. The mesh follows with the next update().
  /// @error those of make_section(), outside_box, cell_limit: nothing has changed
  [[nodiscard]] Result<InsertReport> add(const TrackedSlice& slice);

  /// Takes back a slice, as if it had never been added; replace it by adding another. With Admission::news, slices that
  /// cut nothing elsewhere because of this one are not asked again: they count in the background.
  /// @param id  TrackedSlice::id; of several with this id the last one added
  /// @error invalid_argument: no slice of this id is held; opencl_failed
  /// @cost  that of inserting again all slices in the cells that this one had cut first
  [[nodiscard]] Result<void> withdraw(std::uint64_t id);

  /// Brings the mesh of one detail up to date with all slices added; that of the other waits for its turn.
  /// @error opencl_failed
  [[nodiscard]] Result<UpdateReport> update(Detail detail = Detail::full, Slopes slopes = Slopes::settled);

  /// [Detail] About how many samples a streaming update() of each detail would take now: what its time goes with.
  /// Surfaces that are not drawn in any detail yet are not foreseen.
  /// @cost O(1)
  [[nodiscard]] std::array<std::size_t, kDetails> samples_due() const;

  [[nodiscard]] MeshSnapshot mesh() const;  ///< that of the last update(). O(chunks)
  /// What mesh() was drawn from. Valid until the next update().
  [[nodiscard]] const SampleLattice& samples() const;
  /// How sure vertices of mesh(), or of its joined mesh, are, with the slices added so far.
  [[nodiscard]] Confidence confidence(std::span<const Eigen::Vector3f> points_mm);
  /// What was seen so far and what was not, of the space that the slices' materials span. @cost some 50 ms
  [[nodiscard]] Coverage coverage();
  [[nodiscard]] ReconstructorCounts counts() const;  ///< of mesh() and what it was drawn from
  [[nodiscard]] std::string device_name() const;

 private:
  struct State;
  explicit Reconstructor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft
