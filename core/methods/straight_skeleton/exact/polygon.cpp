#include "core/methods/straight_skeleton/exact/polygon.h"

#include <algorithm>

namespace sonoloft::skeleton {

ExactBox::ExactBox(const Eigen::AlignedBox3d& of, double doubt) : box(of), doubt_mm(doubt) {
  for (std::size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i / 2);
    std::array<Exact, 4> c{Exact(0), Exact(0), Exact(0), Exact(i % 2 == 0 ? -box.min()[axis] : box.max()[axis])};
    c[i / 2] = Exact(i % 2 == 0 ? 1 : -1);
    walls[i] = std::make_shared<const Form>(c);
  }
}

Polygon Polygon::across(const ExactBox& box, FormPtr support) {
  Eigen::Index axis = 0;
  support->rough.head<3>().cwiseAbs().maxCoeff(&axis);
  const auto k = static_cast<std::size_t>(axis), i = (k + 1) % 3, j = (k + 2) % 3;
  Polygon p;
  p.sides = {box.walls[2 * j], box.walls[2 * i + 1], box.walls[2 * j + 1], box.walls[2 * i]};
  if (support->rough[axis] < 0) std::ranges::reverse(p.sides);
  p.support = std::move(support);
  for (std::size_t c = 0; c < 4; ++c) p.corners.emplace_back(p.support, p.sides[(c + 3) % 4], p.sides[c], box.doubt_mm);
  for (const std::size_t wall : {2 * k, 2 * k + 1})
    if (!p.empty()) p.cut(box.walls[wall], box.doubt_mm);
  return p;
}

Cut Polygon::cut(const FormPtr& plane, double doubt_mm) {
  const std::size_t n = corners.size();
  std::vector<int> at(n);
  for (std::size_t i = 0; i < n; ++i) at[i] = side_of(*plane, corners[i], doubt_mm);
  const bool any_out = std::ranges::count(at, -1) > 0, any_in = std::ranges::count(at, 1) > 0;
  if (!any_out) return any_in ? Cut::some : Cut::along;
  if (!any_in) {
    corners.clear();
    sides.clear();
    return Cut::none;
  }
  Polygon kept;
  const auto add = [&](Corner corner, const FormPtr& side) {
    kept.corners.push_back(std::move(corner));
    kept.sides.push_back(side);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const int here = at[i], next = at[(i + 1) % n];
    if (here >= 0) add(corners[i], here == 0 && next < 0 ? plane : sides[i]);
    if (here * next < 0) add(Corner(support, sides[i], plane, doubt_mm), here > 0 ? plane : sides[i]);
  }
  corners = std::move(kept.corners);
  sides = std::move(kept.sides);
  return Cut::some;
}

RoughPolygon::RoughPolygon(const Eigen::AlignedBox3d& box, const Eigen::Vector4d& support, double slack_mm)
    : slack_mm_(slack_mm) {
  const Eigen::Vector3d n = support.head<3>().normalized(), m = n.unitOrthogonal(), t = n.cross(m);
  const double off = (support.head<3>().dot(box.center()) + support.w()) / support.head<3>().norm();
  const double reach = box.diagonal().norm();
  const Eigen::Vector3d middle = box.center() - off * n;
  corners_ = {middle - reach * m - reach * t, middle + reach * m - reach * t, middle + reach * m + reach * t,
              middle - reach * m + reach * t};
}

RoughPolygon::RoughPolygon(const Polygon& polygon, double slack_mm) : slack_mm_(slack_mm) {
  for (const Corner& c : polygon.corners) corners_.push_back(c.rough);
}

bool RoughPolygon::cut(const Eigen::Vector4d& plane) {
  const std::size_t n = corners_.size();
  kept_.clear();
  const auto at = [&](const Eigen::Vector3d& p) { return plane.head<3>().dot(p) + plane.w() + slack_mm_; };
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d &p = corners_[i], &q = corners_[(i + 1) % n];
    const double here = at(p), next = at(q);
    if (here >= 0) kept_.push_back(p);
    if (here * next < 0) kept_.push_back(p + here / (here - next) * (q - p));
  }
  std::swap(corners_, kept_);
  return !corners_.empty();
}

}  // namespace sonoloft::skeleton
