#include "core/mesh/display/display_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace sonoloft {
namespace {

using Indices = std::vector<unsigned>;  ///< three a triangle
constexpr unsigned kNone = std::numeric_limits<unsigned>::max();

/// Gives vertices new numbers in the order they come, and collects them.
class Renumbering {
 public:
  explicit Renumbering(const std::vector<Eigen::Vector3f>& positions)
      : from_(positions), number_(positions.size(), kNone) {}

  unsigned operator()(unsigned vertex) {
    if (number_[vertex] == kNone) {
      number_[vertex] = static_cast<unsigned>(original_.size());
      original_.push_back(vertex);
    }
    return number_[vertex];
  }
  [[nodiscard]] unsigned original(unsigned number) const { return original_[number]; }
  [[nodiscard]] std::vector<Eigen::Vector3f> positions() const {
    std::vector<Eigen::Vector3f> positions;
    for (const unsigned vertex : original_) positions.push_back(from_[vertex]);
    return positions;
  }
  /// For the next numbering; costs what this one did.
  void clear() {
    for (const unsigned vertex : original_) number_[vertex] = kNone;
    original_.clear();
  }

 private:
  const std::vector<Eigen::Vector3f>& from_;
  std::vector<unsigned> number_, original_;
};

/// Simplifies a surface to about `count` indices. @return how far it is from what it was
double simplify(Indices& surface, std::size_t count, Renumbering& numbers) {
  numbers.clear();
  Indices local;
  for (const unsigned vertex : surface) local.push_back(numbers(vertex));
  const std::vector<Eigen::Vector3f> positions = numbers.positions();
  Indices fewer(local.size());
  float error = 0;  // of the largest extent
  constexpr float kAnyError = 1;
  const float* first = positions.front().data();
  fewer.resize(meshopt_simplify(fewer.data(), local.data(), local.size(), first, positions.size(), sizeof positions[0],
                                count, kAnyError, meshopt_SimplifyLockBorder, &error));
  if (fewer.empty()) return 0;
  surface.clear();
  for (const unsigned vertex : fewer) surface.push_back(numbers.original(vertex));
  return static_cast<double>(error) *
         static_cast<double>(meshopt_simplifyScale(first, positions.size(), sizeof positions[0]));
}

}  // namespace

DisplayMesh simplify_for_display(const IndexedMesh& mesh, std::size_t triangles) {
  std::map<std::pair<Label, Label>, Indices> surfaces;  ///< by labels in front and behind
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Indices& surface = surfaces[{mesh.label_front[t], mesh.label_back[t]}];
    surface.insert(surface.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  const double share = std::min(1.0, static_cast<double>(triangles) / static_cast<double>(mesh.triangles.size()));
  DisplayMesh result{{}, 0};
  Renumbering numbers(mesh.positions);
  for (auto& [labels, surface] : surfaces)
    if (share < 1) {
      const auto count = static_cast<std::size_t>(share * static_cast<double>(surface.size() / 3)) * 3;
      result.error_mm = std::max(result.error_mm, simplify(surface, count, numbers));
    }
  numbers.clear();
  for (const auto& [labels, surface] : surfaces)
    for (std::size_t i = 0; i < surface.size(); i += 3) {
      result.mesh.triangles.push_back({numbers(surface[i]), numbers(surface[i + 1]), numbers(surface[i + 2])});
      result.mesh.label_front.push_back(labels.first);
      result.mesh.label_back.push_back(labels.second);
    }
  result.mesh.positions = numbers.positions();
  return result;
}

}  // namespace sonoloft
