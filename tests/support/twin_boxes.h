#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/mesh/mesh.h"

namespace sonoloft::test {

/// Two boxes that share the wall x = 1: label 2 is [0,1] x [0,2] x [0,3], label 5 is [1,3] x [0,2] x [0,3]. Every other
/// face borders on outside: 20 triangles, and 2 of the wall.
inline MeshSnapshot twin_boxes(float stretch = 1) {
  auto chunk = std::make_shared<MeshChunk>();
  const auto vertex = [&](int x, int y, int z) { return static_cast<std::uint32_t>(x * 4 + y * 2 + z); };
  for (const float x : {0.0f, 1.0f, 3.0f})
    for (const float y : {0.0f, 2.0f})
      for (const float z : {0.0f, 3.0f}) {
        chunk->vertex_keys.push_back(chunk->positions.size());
        chunk->positions.emplace_back(stretch * x, stretch * y, stretch * z);
      }
  const auto quad = [&](std::array<std::uint32_t, 4> q, Label front, Label back) {
    for (const auto& t : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
      chunk->triangles.push_back(t);
      chunk->label_front.push_back(front);
      chunk->label_back.push_back(back);
    }
  };
  const auto across = [&](int x, Label front, Label back) {  // its normal is +x
    quad({vertex(x, 0, 0), vertex(x, 1, 0), vertex(x, 1, 1), vertex(x, 0, 1)}, front, back);
  };
  across(0, 2, 0);
  across(1, 5, 2);
  across(2, 0, 5);
  for (int x = 0; x < 2; ++x) {
    const Label label = x == 0 ? 2 : 5;
    quad({vertex(x, 0, 0), vertex(x, 0, 1), vertex(x + 1, 0, 1), vertex(x + 1, 0, 0)}, label, 0);  // y = 0, normal +y
    quad({vertex(x, 1, 0), vertex(x, 1, 1), vertex(x + 1, 1, 1), vertex(x + 1, 1, 0)}, 0, label);
    quad({vertex(x, 0, 0), vertex(x + 1, 0, 0), vertex(x + 1, 1, 0), vertex(x, 1, 0)}, label, 0);  // z = 0, normal +z
    quad({vertex(x, 0, 1), vertex(x + 1, 0, 1), vertex(x + 1, 1, 1), vertex(x, 1, 1)}, 0, label);
  }
  return {{chunk}};
}

}  // namespace sonoloft::test
