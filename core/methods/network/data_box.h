#pragma once
#include <Eigen/Geometry>
#include <span>

#include "core/slice/section.h"

namespace sonoloft::network {

/// A box of twice the size of what slices show, about its middle; empty where they show nothing. Reference, mm.
[[nodiscard]] Eigen::AlignedBox3d box_around(std::span<const Section> sections);

}  // namespace sonoloft::network
