#pragma once
// Transforms by name:  configuration, frame -> [TRANSFORM GRAPH] -> where the image is in the reference
#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/sequences/plus_config.h"
#include "core/io/sequences/tracked_sequence.h"
#include "core/slice/result.h"

namespace sonoloft {

struct TransformName {
  std::string from, to;
};

/// `ProbeToTracker` taken apart: at the one "To" that something precedes and that no small letter follows; nothing
/// where there is none, or more of them.
[[nodiscard]] std::optional<TransformName> parse_transform_name(std::string_view name);

/// Coordinate systems and the transforms between them, each of which also leads back, as PLUS's transform repository.
/// Threads: reading from any.
class TransformGraph {
 public:
  /// States a transform, or that there is one without a good value now. Replaces what was stated of these two, either
  /// way round. @pre the matrix has an inverse
  void set(const std::string& from, const std::string& to, const std::optional<Eigen::Affine3d>& from_to_to);

  void set(const PlusConfig& config);
  /// Fields whose name is no transform's are left out.
  void set(const SequenceFrame& frame);

  /// Along the fewest good transforms; of several such ways always the same one. Nothing where there is no way.
  /// @cost O(transforms)
  [[nodiscard]] std::optional<Eigen::Affine3d> find(const std::string& from, const std::string& to) const;

  /// @error invalid_argument: no way even when all are good; says what can be reached from either end
  [[nodiscard]] Result<void> check_connected(const std::string& from, const std::string& to) const;

 private:
  using Links = std::map<std::string, std::optional<Eigen::Affine3d>>;  ///< to what, and by what
  struct Reached {
    std::string system;
    Eigen::Affine3d from_start;
  };
  [[nodiscard]] std::vector<Reached> reach(const std::string& from, bool good_only) const;

  std::map<std::string, Links> links_;  ///< by what they lead from; both ways round
};

/// The rigid transform that stands for one that was written with few digits; nothing where its axes are off by more
/// than 1 %.
[[nodiscard]] std::optional<Eigen::Isometry3d> rigid(const Eigen::Affine3d& transform);

/// Where `from` is in `to` by a frame's own transforms; nothing where no good ones lead there, or no rigid ones.
[[nodiscard]] std::optional<Eigen::Isometry3d> transform_between(const SequenceFrame& frame, const std::string& from,
                                                                 const std::string& to);

}  // namespace sonoloft
