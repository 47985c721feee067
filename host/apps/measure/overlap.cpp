#include "host/apps/measure/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

/// A place along a line where a label begins or ends.
struct Toggle {
  std::uint32_t line;
  Label label;
  bool truth;
  double x;
};

struct Sum {
  double mesh = 0, truth = 0, common = 0;
};

class RowScan {
 public:
  RowScan(const ScanLines& lines, std::vector<Sum>& sums, const std::vector<std::uint32_t>& slot_of_label)
      : lines_(lines), sums_(sums), slot_of_label_(slot_of_label) {}

  void add_mesh(const IndexedMesh& mesh, const LineScan& scan, std::size_t row, bool truth) {
    scan.crossings(row, [&](std::uint32_t line, double x, std::size_t triangle) {
      const double place = lines_.x.count == 0 ? x : std::ceil((x - lines_.x.start) / lines_.x.step);
      add(line, mesh.label_front[triangle], mesh.label_back[triangle], place, truth);
    });
  }

  void add_voxels(const LabelVolume& volume, const std::array<std::size_t, 3>& offset, std::size_t row) {
    const std::size_t nx = volume.dims[0], ny = volume.dims[1], nz = volume.dims[2];
    if (row < offset[2] || row - offset[2] >= nz) return;
    for (std::size_t j = 0; j < ny; ++j) {
      const Label* const labels = volume.labels.data() + nx * (j + ny * (row - offset[2]));
      const auto line = static_cast<std::uint32_t>(j + offset[1]);
      Label before = kOutside;
      for (std::size_t i = 0; i <= nx; ++i) {
        const Label label = i < nx ? labels[i] : kOutside;
        if (label != before) add(line, before, label, static_cast<double>(i + offset[0]), true);
        before = label;
      }
    }
  }

  /// Sums up what was added. Returns the number of lines and labels that did not close.
  std::size_t finish() {
    std::sort(toggles_.begin(), toggles_.end(), [](const Toggle& a, const Toggle& b) {
      return std::tie(a.line, a.label, a.x, a.truth) < std::tie(b.line, b.label, b.x, b.truth);
    });
    std::size_t open = 0;
    for (std::size_t begin = 0, end = 0; begin < toggles_.size(); begin = end) {
      Sum& sum = sums_[slot_of_label_[toggles_[begin].label]];
      bool in_mesh = false, in_truth = false;
      for (end = begin; same_group(begin, end); ++end) {
        (toggles_[end].truth ? in_truth : in_mesh) ^= true;
        if (!same_group(begin, end + 1)) break;
        const double length = toggles_[end + 1].x - toggles_[end].x;
        if (in_mesh) sum.mesh += length;
        if (in_truth) sum.truth += length;
        if (in_mesh && in_truth) sum.common += length;
      }
      ++end;
      open += in_mesh || in_truth;
    }
    toggles_.clear();
    return open;
  }

 private:
  [[nodiscard]] bool same_group(std::size_t begin, std::size_t i) const {
    return i < toggles_.size() && toggles_[i].line == toggles_[begin].line &&
           toggles_[i].label == toggles_[begin].label;
  }

  void add(std::uint32_t line, Label one, Label other, double x, bool truth) {
    if (one != kOutside) toggles_.push_back({line, one, truth, x});
    if (other != kOutside) toggles_.push_back({line, other, truth, x});
  }

  const ScanLines& lines_;
  std::vector<Sum>& sums_;
  const std::vector<std::uint32_t>& slot_of_label_;
  std::vector<Toggle> toggles_;
};

std::vector<Label> labels_of(const OverlapInput& input) {
  std::vector<bool> seen(std::size_t{1} << 16);
  for (const IndexedMesh* mesh : {&input.mesh, input.truth_mesh}) {
    if (mesh == nullptr) continue;
    for (const Label label : mesh->label_front) seen[label] = true;
    for (const Label label : mesh->label_back) seen[label] = true;
  }
  if (input.truth_voxels != nullptr) {
    for (const Label label : input.truth_voxels->labels) seen[label] = true;
  }
  std::vector<Label> labels;
  for (std::size_t label = 1; label < seen.size(); ++label) {
    if (seen[label]) labels.push_back(static_cast<Label>(label));
  }
  return labels;
}

}  // namespace

Overlap scan_overlap(const OverlapInput& input, const ScanLines& lines, int threads) {
  constexpr std::size_t kBands = 64;  // fixed, so that the order of summation is
  const std::vector<Label> labels = labels_of(input);
  std::vector<std::uint32_t> slot_of_label(std::size_t{1} << 16);
  for (std::size_t i = 0; i < labels.size(); ++i) slot_of_label[labels[i]] = static_cast<std::uint32_t>(i);

  const LineScan mesh_scan(input.mesh, lines.y, lines.z);
  std::optional<LineScan> truth_scan;
  if (input.truth_mesh != nullptr) truth_scan.emplace(*input.truth_mesh, lines.y, lines.z);
  std::vector<std::vector<Sum>> sums(kBands, std::vector<Sum>(labels.size()));
  std::array<std::size_t, kBands> open{};
  parallel_for(kBands, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t band = first; band < last; ++band) {
      RowScan scan(lines, sums[band], slot_of_label);
      for (std::size_t row = lines.z.count * band / kBands; row < lines.z.count * (band + 1) / kBands; ++row) {
        scan.add_mesh(input.mesh, mesh_scan, row, false);
        if (truth_scan) scan.add_mesh(*input.truth_mesh, *truth_scan, row, true);
        if (input.truth_voxels != nullptr) scan.add_voxels(*input.truth_voxels, input.voxel_offset, row);
        open[band] += scan.finish();
      }
    }
  });

  const double unit_mm3 = lines.y.step * lines.z.step * (lines.x.count == 0 ? 1.0 : lines.x.step);
  Overlap overlap{{}, 0};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    Sum total;
    for (const auto& band : sums) {
      total.mesh += band[i].mesh, total.truth += band[i].truth, total.common += band[i].common;
    }
    overlap.labels.push_back({labels[i], total.mesh * unit_mm3, total.truth * unit_mm3, total.common * unit_mm3});
  }
  for (const std::size_t lines_of_band : open) overlap.open_lines += lines_of_band;
  return overlap;
}

}  // namespace sonoloft
