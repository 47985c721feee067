#include "core/methods/straight_skeleton/patch/image.h"

namespace sonoloft::skeleton {
namespace {

using Vector = std::array<Exact, 3>;

Vector exactly(const Eigen::Vector3d& v) {
  return {Exact(v.x()), Exact(v.y()), Exact(v.z())};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Exact dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

FormPtr form_through(const Vector& gradient, const Vector& zero) {
  return std::make_shared<const Form>(
      std::array{gradient[0], gradient[1], gradient[2], Exact(-1) * dot(gradient, zero)});
}

double length(const Spot& a, const Spot& b) {
  return (b.rough - a.rough).norm();
}

/// Rough coordinates are this exact, of the largest of them.
constexpr double kDoubt = 1e-14;

}  // namespace

Spot::Spot(Exact px, Exact py) : x(std::move(px)), y(std::move(py)) {
  rough = {CGAL::to_double(x.value.exact()), CGAL::to_double(y.value.exact())};
}

int turn(const Spot& a, const Spot& b, const Spot& c) {
  const Eigen::Vector2d ab = b.rough - a.rough, ac = c.rough - a.rough;
  const double value = ab.x() * ac.y() - ab.y() * ac.x();
  const double size = a.rough.cwiseAbs().cwiseMax(b.rough.cwiseAbs()).cwiseMax(c.rough.cwiseAbs()).maxCoeff();
  if (std::abs(value) > kDoubt * size * (ab.norm() + ac.norm())) return value > 0 ? 1 : -1;
  return sign_of(cross(a, b, a, c));
}

Spot between(const Spot& a, const Spot& b, const Exact& t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

Exact cross(const Spot& a, const Spot& b, const Spot& c, const Spot& d) {
  return (b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x);
}

Image::Image(const Eigen::Isometry3d& frame)
    : origin_(exactly(frame.translation())),
      x_axis_(exactly(frame.linear().col(0))),
      y_axis_(exactly(frame.linear().col(1))),
      rough_axes_(frame.linear().leftCols<2>()) {
  const Eigen::Vector3d n = frame.linear().col(2);
  const Vector normal = exactly(n);
  height = std::make_shared<const Form>(
      std::array{normal[0], normal[1], normal[2], Exact(-n.dot(frame.translation()))});  // as the cells have it
  const Vector over_x = cross(y_axis_, normal), over_y = cross(normal, x_axis_);
  x_ = form_through(over_x, origin_);
  y_ = form_through(over_y, origin_);
  unit_ = dot(x_axis_, over_x);
}

FormPtr Image::form(const Exact& a, const Exact& b, const Exact& c) const {
  std::array<Exact, 4> of;
  for (std::size_t i = 0; i < 4; ++i) of[i] = a * x_->c[i] + b * y_->c[i];
  of[3] = of[3] + c * unit_;
  return std::make_shared<const Form>(of);
}

FormPtr Image::line(const Spot& a, const Spot& b) const {
  const Exact scale(1 / length(a, b)), dx = scale * (b.x - a.x), dy = scale * (b.y - a.y);
  return form(Exact(-1) * dy, dx, dy * a.x - dx * a.y);
}

FormPtr Image::along(const Spot& a, const Spot& b, const Spot& at) const {
  const Exact scale(1 / length(a, b)), dx = scale * (b.x - a.x), dy = scale * (b.y - a.y);
  return form(dx, dy, Exact(-1) * (dx * at.x + dy * at.y));
}

Corner Image::place(const Spot& p) const {
  std::array<Exact, 3> at;
  for (std::size_t i = 0; i < 3; ++i) at[i] = origin_[i] + p.x * x_axis_[i] + p.y * y_axis_[i];
  return Corner(at);
}

Eigen::Vector2d Image::foot(const Corner& p) const {
  return {x_->near(p.rough), y_->near(p.rough)};
}

int Image::compare_x(const Corner& p, const Spot& q) const {
  if (x_->residue_at(p) == (q.x * unit_).residue * p.residues()[3]) return 0;
  return network::sign_of(x_->at(p.at()) - q.x.value * unit_.value);
}

}  // namespace sonoloft::skeleton
