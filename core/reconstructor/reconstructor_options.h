#pragma once
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/field/device_choice.h"
#include "core/field/field_method.h"
#include "core/reconstructor/stack_caps.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// Where a slice cuts the cells that its known part reaches.
enum class Admission : std::uint8_t {
  everything,  ///< everywhere: every slice is interpolated; for recorded sets of up to some hundred slices
  news,        ///< where it says what the slices before do not say already: the rest counts in the background only;
               ///< for sweeps of any length
};

/// What fills the share of the field that no slice measured.
enum class Completion : std::uint8_t {
  background,  ///< one function for all of space (Background)
  published,   ///< patches on the unknown parts of walls (PublishedCompletion), made anew by every update() after a
               ///< change: seconds to minutes, for comparison and for recorded sets of few slices
};

struct ReconstructorOptions {
  Eigen::AlignedBox3d box;     ///< the space of the scan, reference, mm; its walls are outside of every object, so
                               ///< keep it about one object larger than the object on every side
  double spacing_mm = 0;       ///< edge of a finest cell: what is finer than this is not drawn; > 0
  double background_mm = 2.5;  ///< node spacing of the background, which fills what no slice shows: about a 60th of the
                               ///< object; how much of `news` counts is measured in it too, and corners of the
                               ///< published completion are that far apart; > 0
  FieldMethod field = FieldMethod::smooth;
  Caps caps = Caps::gap;  ///< of slices in parallel planes; others see the ends of the object from the side
  Admission admission = Admission::news;
  Completion completion = Completion::background;  ///< `published` needs Admission::everything
  std::optional<int> hops;  ///< of `published`: how many unknown walls away cells are asked, >= 1; none: all of them
  DeviceChoice device = DeviceChoice::automatic;
  int threads = 1;                                   ///< >= 1; results do not depend on it
  std::function<void(const std::string& line)> log;  ///< one line on the chosen device; may be empty
};

/// For recorded slices, each of which is to be interpolated: the box of all contours, widened by its longest side on
/// every side, a spacing of 1.1 longest sides / 2^depth, and a background of 1.1 longest sides / 64.
/// @pre  2 <= depth <= 12
/// @error empty_input (no contour in any slice)
[[nodiscard]] Result<ReconstructorOptions> options_for(std::span<const TrackedSlice> slices, int depth);

/// Whether a Reconstructor can be made of them.
/// @error invalid_argument: what is wrong, and what would be right
[[nodiscard]] Result<void> check(const ReconstructorOptions& options);

}  // namespace sonoloft
