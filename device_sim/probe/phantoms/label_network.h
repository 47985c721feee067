#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "device_sim/probe/phantom.h"

namespace sonoloft::device_sim {

/// The borders between the regions of a section as a planar network: every vertex joins two segments, or more at a
/// junction; every segment knows the label on both sides.
class LabelNetwork {
 public:
  [[nodiscard]] std::uint32_t add_vertex(const Eigen::Vector2d& point);
  /// A piece of border, part of a chain, between two vertices that are no junctions.
  void add_segment(std::uint32_t a, std::uint32_t b, Label left, Label right);
  /// A junction joined to `ends` by straight pieces.
  /// @param ends   [3 or 4] in counter-clockwise order
  /// @param after  [as ends] the label of the region that follows ends[i] counter-clockwise
  void add_junction(const Eigen::Vector2d& point, std::span<const std::uint32_t> ends, std::span<const Label> after);

  /// The loop around every bounded region. Of the vertices of long chains only some are kept, at least min_gap_mm
  /// apart and the same for both sides.
  /// @pre every vertex has two segments or more
  [[nodiscard]] PhantomSection loops(double min_gap_mm) const;

 private:
  /// 2 s runs along segment s, 2 s + 1 against it.
  using HalfEdge = std::uint32_t;
  struct Segment {
    std::uint32_t a, b;
    Label left, right;
  };
  struct Vertex {
    Eigen::Vector2d point;
    std::array<HalfEdge, 4> out{};  ///< [degree] counter-clockwise
    std::uint32_t degree = 0;
  };

  [[nodiscard]] std::uint32_t from(HalfEdge h) const { return h & 1 ? segments_[h / 2].b : segments_[h / 2].a; }
  [[nodiscard]] std::uint32_t to(HalfEdge h) const { return from(h ^ 1); }
  [[nodiscard]] Label left_of(HalfEdge h) const { return h & 1 ? segments_[h / 2].right : segments_[h / 2].left; }
  void connect(std::uint32_t a, std::uint32_t b, Label left, Label right);
  [[nodiscard]] HalfEdge next_around_region(HalfEdge h) const;
  void thin_chain(HalfEdge start, double min_gap_mm, std::vector<char>& seen, std::vector<char>& keep) const;
  [[nodiscard]] std::vector<char> kept_vertices(double min_gap_mm) const;

  std::vector<Vertex> vertices_;
  std::vector<Segment> segments_;
};

}  // namespace sonoloft::device_sim
