#include "core/tracking/transform_graph.h"

#include <algorithm>
#include <cctype>

namespace sonoloft {

std::optional<TransformName> parse_transform_name(std::string_view name) {
  constexpr std::string_view kTo = "To";
  std::optional<TransformName> parsed;
  for (std::size_t at = name.find(kTo, 1); at != std::string_view::npos; at = name.find(kTo, at + 1)) {
    const std::string_view to = name.substr(at + kTo.size());
    if (to.empty() || std::islower(static_cast<unsigned char>(to[0])) != 0) continue;
    if (parsed) return std::nullopt;
    parsed = TransformName{std::string(name.substr(0, at)), std::string(to)};
  }
  return parsed;
}

void TransformGraph::set(const std::string& from, const std::string& to,
                         const std::optional<Eigen::Affine3d>& from_to_to) {
  if (from == to) return;
  links_[from][to] = from_to_to;
  links_[to][from] = from_to_to ? std::optional(from_to_to->inverse()) : std::nullopt;
}

void TransformGraph::set(const PlusConfig& config) {
  for (const PlusTransform& transform : config.transforms) set(transform.from, transform.to, transform.matrix);
}

void TransformGraph::set(const SequenceFrame& frame) {
  for (const auto& [text, transform] : frame.transforms)
    if (const auto name = parse_transform_name(text)) set(name->from, name->to, transform);
}

std::vector<TransformGraph::Reached> TransformGraph::reach(const std::string& from, bool good_only) const {
  std::vector<Reached> reached{{from, Eigen::Affine3d::Identity()}};
  for (std::size_t i = 0; i < reached.size(); ++i) {  // breadth first
    const auto links = links_.find(reached[i].system);
    if (links == links_.end()) continue;
    for (const auto& [to, transform] : links->second) {
      if (std::ranges::count(reached, to, &Reached::system) > 0 || (good_only && !transform)) continue;
      reached.push_back({to, transform.value_or(Eigen::Affine3d::Identity()) * reached[i].from_start});
    }
  }
  return reached;
}

std::optional<Eigen::Affine3d> TransformGraph::find(const std::string& from, const std::string& to) const {
  for (const Reached& r : reach(from, true))
    if (r.system == to) return r.from_start;
  return std::nullopt;
}

Result<void> TransformGraph::check_connected(const std::string& from, const std::string& to) const {
  const auto list = [](const std::vector<Reached>& reached) {
    std::string text;
    for (const Reached& r : reached) text += (text.empty() ? "" : ", ") + r.system;
    return text;
  };
  const auto reached = reach(from, false);
  if (std::ranges::count(reached, to, &Reached::system) > 0) return {};
  return fail(ErrorCode::invalid_argument, "no transforms lead from " + from + " to " + to + ": joined are {" +
                                               list(reached) + "} and {" + list(reach(to, false)) +
                                               "}: name others, or state one between the two in the configuration");
}

std::optional<Eigen::Isometry3d> rigid(const Eigen::Affine3d& transform) {
  constexpr double kTolerance = 1e-2;
  const Eigen::Matrix3d axes = transform.linear();
  const double off = (axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < kTolerance) || axes.determinant() < 0) return std::nullopt;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(axes).normalized().toRotationMatrix();
  pose.translation() = transform.translation();
  return pose;
}

std::optional<Eigen::Isometry3d> transform_between(const SequenceFrame& frame, const std::string& from,
                                                   const std::string& to) {
  TransformGraph graph;
  graph.set(frame);
  const auto found = graph.find(from, to);
  return found ? rigid(*found) : std::nullopt;
}

}  // namespace sonoloft
