#include "device_sim/probe/phantoms/volume_phantom.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "device_sim/probe/phantoms/section_tracer.h"

namespace sonoloft::device_sim {
namespace {

std::string check(const Eigen::Vector3i& dims, const Eigen::Vector3d& spacing_mm, const Eigen::Vector3d& origin_mm,
                  std::span<const Label> labels) {
  if ((dims.array() <= 0).any()) return "volume: it has no voxels along an axis; check its dimensions";
  const double count = dims.cast<double>().prod();
  if (count > 0x1p31) return "volume: over 2^31 voxels; crop or thin it";
  if (count != static_cast<double>(labels.size()))
    return "volume: " + std::to_string(labels.size()) + " labels do not fill its dimensions; check both";
  if (!spacing_mm.allFinite() || (spacing_mm.array() <= 0).any() || !origin_mm.allFinite())
    return "volume: the voxel spacing must be positive and the origin finite; check its header";
  if (std::any_of(labels.begin(), labels.end(), [](Label l) { return l >= kFirstReservedLabel; }))
    return "volume: labels from 65521 are reserved; map them to smaller ones";
  if (std::all_of(labels.begin(), labels.end(), [](Label l) { return l == kOutside; }))
    return "volume: no voxel has a label; nothing could be scanned";
  return {};
}

/// The voxels that have a label. Frame: voxels.
Eigen::AlignedBox3i labelled(const Eigen::Vector3i& dims, std::span<const Label> labels) {
  Eigen::AlignedBox3i box;
  const auto row_length = static_cast<std::size_t>(dims.x());
  for (int z = 0; z < dims.z(); ++z) {
    for (int y = 0; y < dims.y(); ++y) {
      const std::size_t first =
          (static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.y()) + static_cast<std::size_t>(y)) * row_length;
      const auto row = labels.subspan(first, row_length);
      const auto is_labelled = [](Label l) { return l != kOutside; };
      const auto left = std::find_if(row.begin(), row.end(), is_labelled);
      if (left == row.end()) continue;
      const auto right = std::find_if(row.rbegin(), row.rend(), is_labelled);
      box.extend(Eigen::Vector3i(static_cast<int>(left - row.begin()), y, z));
      box.extend(Eigen::Vector3i(static_cast<int>(row.rend() - right) - 1, y, z));
    }
  }
  return box;
}

}  // namespace

Made<VolumePhantom> VolumePhantom::make(const Eigen::Vector3i& dims, const Eigen::Vector3d& spacing_mm,
                                        const Eigen::Vector3d& origin_mm, std::span<const Label> labels) {
  constexpr double kSigmaOfCoarsestEdge = 0.75;
  std::string error = check(dims, spacing_mm, origin_mm, labels);
  if (!error.empty()) return {nullptr, std::move(error)};
  std::unique_ptr<VolumePhantom> phantom(new VolumePhantom);
  const Eigen::Vector3d sigma_voxel =
      (kSigmaOfCoarsestEdge * spacing_mm.maxCoeff() * spacing_mm.cwiseInverse()).cwiseMin(SmoothLabels::kMaxSigmaVoxel);
  phantom->labels_ = SmoothLabels(dims, sigma_voxel, labels);
  phantom->origin_mm_ = origin_mm;
  phantom->voxels_per_mm_ = spacing_mm.cwiseInverse();
  phantom->grid_mm_ = std::cbrt(spacing_mm.prod());
  const Eigen::AlignedBox3i box = labelled(dims, labels);
  const Eigen::Vector3d low = (box.min().cast<double>().array() - 1).matrix();
  const Eigen::Vector3d high = (box.max().cast<double>().array() + 1).matrix();
  phantom->bounds_ = {origin_mm + low.cwiseProduct(spacing_mm), origin_mm + high.cwiseProduct(spacing_mm)};
  return {std::move(phantom), {}};
}

PhantomSection VolumePhantom::section(const Eigen::Isometry3d& plane_to_reference) const {
  return trace_section(section_area(bounds_, plane_to_reference), plane_to_reference, grid_mm_,
                       [this](const Eigen::Vector3d& point_mm) { return label_at(point_mm); });
}

PhantomSection VolumePhantom::section_in(const Eigen::AlignedBox2d& window,
                                         const Eigen::Isometry3d& plane_to_reference) const {
  return trace_section(section_area(bounds_, plane_to_reference).intersection(window), plane_to_reference, grid_mm_,
                       [this](const Eigen::Vector3d& point_mm) { return label_at(point_mm); });
}

}  // namespace sonoloft::device_sim
