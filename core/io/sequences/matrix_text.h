#pragma once
#include <Eigen/Geometry>
#include <string>
#include <string_view>

#include "core/slice/result.h"

namespace sonoloft {

/// Sixteen numbers of an invertible affine map, row by row; `name` is what messages call them.
/// @error parse_failed, non_finite
[[nodiscard]] Result<Eigen::Affine3d> parse_matrix(std::string_view text, const std::string& name);

}  // namespace sonoloft
