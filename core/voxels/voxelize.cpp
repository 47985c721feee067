#include "core/voxels/voxelize.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <compare>
#include <sstream>
#include <string>
#include <vector>

#include "core/slice/parallel.h"
#include "core/voxels/line_scan.h"

namespace sonoloft {
namespace {

/// A voxel of a line from whose centre on a label is begun or ended.
struct Toggle {
  std::uint32_t line;
  std::uint32_t voxel;
  Label label;
  auto operator<=>(const Toggle&) const = default;
};

/// One layer of voxels after the other.
class LayerFill {
 public:
  LayerFill(const IndexedMesh& mesh, const LineScan& scan, const Ticks& x, LabelVolume& volume)
      : mesh_(mesh), scan_(scan), x_(x), volume_(volume) {}

  /// Returns the number of lines on which a label has no end.
  std::size_t fill(std::size_t layer) {
    toggles_.clear();
    scan_.crossings(layer, [&](std::uint32_t line, double x, std::size_t triangle) {
      const auto voxel = static_cast<std::uint32_t>(x_.first_not_below(x));
      for (const Label label : {mesh_.label_front[triangle], mesh_.label_back[triangle]})
        if (label != kOutside) toggles_.push_back({line, voxel, label});
    });
    std::ranges::sort(toggles_);
    Label* const first = volume_.labels.data() + layer * volume_.dims[1] * volume_.dims[0];
    std::size_t open = 0;
    for (std::size_t i = 0; i < toggles_.size(); open += inside_.empty() ? 0 : 1)
      i = fill_line(i, first + std::size_t{toggles_[i].line} * volume_.dims[0]);
    return open;
  }

 private:
  /// Returns where the toggles of the next line begin.
  std::size_t fill_line(std::size_t i, Label* labels) {
    inside_.clear();
    for (const std::uint32_t line = toggles_[i].line; i < toggles_.size() && toggles_[i].line == line; ++i) {
      if (!inside_.empty()) std::fill(labels + toggles_[i - 1].voxel, labels + toggles_[i].voxel, inside_.front());
      const auto place = std::ranges::lower_bound(inside_, toggles_[i].label);
      if (place != inside_.end() && *place == toggles_[i].label)
        inside_.erase(place);
      else
        inside_.insert(place, toggles_[i].label);
    }
    return i;
  }

  const IndexedMesh& mesh_;
  const LineScan& scan_;
  const Ticks& x_;
  LabelVolume& volume_;
  std::vector<Toggle> toggles_;
  std::vector<Label> inside_;  ///< begun and not ended, ascending: one, unless the mesh runs through itself
};

Result<LabelVolume> empty_volume(const Eigen::AlignedBox3d& box, double voxel_mm) {
  if (!(voxel_mm > 0) || !std::isfinite(voxel_mm))
    return fail(ErrorCode::invalid_argument, "voxels of " + std::to_string(voxel_mm) + " mm: give a positive length");
  const Eigen::Array3d low = (box.min() / voxel_mm).array().floor() - 1;
  const Eigen::Array3d sides = (box.max() / voxel_mm).array().floor() + 2 - low;
  // Less than three: so far out that the next voxel is the same number.
  if (!(sides.minCoeff() >= 3) || !(sides.maxCoeff() <= kMaxVolumeSide) ||
      !(sides.prod() <= static_cast<double>(kMaxVolumeVoxels))) {
    std::ostringstream message;
    message << "voxels of " << voxel_mm << " mm are too many for a mesh of " << box.sizes().transpose()
            << " mm: at most " << kMaxVolumeSide << " a side and 2^29 in all; give a larger length";
    return fail(ErrorCode::too_large, message.str());
  }
  LabelVolume volume;
  for (const int axis : {0, 1, 2})
    volume.dims[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(sides[axis]);
  volume.spacing_mm.setConstant(voxel_mm);
  volume.origin_mm = (low + 0.5) * voxel_mm;
  volume.labels.assign(static_cast<std::size_t>(sides.prod()), kOutside);
  return volume;
}

}  // namespace

Result<LabelVolume> voxelize(const IndexedMesh& mesh, double voxel_mm, int threads) {
  const auto box = used_box(mesh, "the mesh");
  if (!box) return tl::unexpected<Error>(box.error());
  auto volume = empty_volume(*box, voxel_mm);
  if (!volume) return volume;
  const auto ticks = [&](int axis) {
    return Ticks{volume->origin_mm[axis], voxel_mm, volume->dims[static_cast<std::size_t>(axis)]};
  };
  const Ticks x = ticks(0);
  const LineScan scan(mesh, ticks(1), ticks(2));
  std::atomic<std::size_t> open = 0;
  parallel_for(volume->dims[2], 4, threads, [&](std::size_t first, std::size_t last) {
    LayerFill layers(mesh, scan, x, *volume);
    for (std::size_t layer = first; layer < last; ++layer) open += layers.fill(layer);
  });
  if (open > 0)
    return fail(ErrorCode::bad_contour, "the mesh is not closed: on " + std::to_string(open) +
                                            " lines of voxels a label has no end: repair the mesh");
  return volume;
}

}  // namespace sonoloft
