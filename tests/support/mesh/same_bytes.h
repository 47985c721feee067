#pragma once
#include <cstring>
#include <vector>

#include "core/mesh/mesh.h"

namespace sonoloft::test {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool same_bytes(const IndexedMesh& a, const IndexedMesh& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.triangles, b.triangles) &&
         same_bytes(a.label_front, b.label_front) && same_bytes(a.label_back, b.label_back);
}

}  // namespace sonoloft::test
