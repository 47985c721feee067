#pragma once
#include <set>

#include "core/mesh/mesh.h"

namespace sonoloft {

/// The labels that a mesh bounds, without outside.
[[nodiscard]] inline std::set<Label> materials_of(const IndexedMesh& mesh) {
  std::set<Label> labels(mesh.label_front.begin(), mesh.label_front.end());
  labels.insert(mesh.label_back.begin(), mesh.label_back.end());
  labels.erase(kOutside);
  return labels;
}

/// The label whose colour a triangle has.
[[nodiscard]] inline Label shown_label(Label front, Label back) {
  return back != kOutside ? back : front;
}

}  // namespace sonoloft
