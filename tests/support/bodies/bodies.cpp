#include "tests/support/bodies/bodies.h"

#include <cmath>
#include <functional>
#include <utility>

#include "device_sim/probe/phantoms/section_tracer.h"
#include "device_sim/probe/phantoms/solid_phantom.h"

namespace sonoloft::test {
namespace {

namespace sim = device_sim;
using Eigen::Vector3d;

/// What solids cannot say.
class Formula final : public sim::Phantom {
 public:
  using LabelAt = std::function<sim::Label(const Vector3d&)>;

  Formula(const Eigen::AlignedBox3d& bounds, LabelAt label_at) : bounds_(bounds), label_at_(std::move(label_at)) {}

  [[nodiscard]] Eigen::AlignedBox3d bounds() const override { return bounds_; }
  [[nodiscard]] sim::Label label_at(const Vector3d& point_mm) const override { return label_at_(point_mm); }
  [[nodiscard]] sim::PhantomSection section(const Eigen::Isometry3d& plane_to_reference) const override {
    constexpr double kLinesOnDiagonal = 400;
    return sim::trace_section(sim::section_area(bounds_, plane_to_reference), plane_to_reference,
                              bounds_.diagonal().norm() / kLinesOnDiagonal, label_at_);
  }

 private:
  Eigen::AlignedBox3d bounds_;
  LabelAt label_at_;
};

Eigen::Isometry3d tilted() {
  return Eigen::Isometry3d(Eigen::AngleAxisd(0.6, Vector3d(1, 2, 0.5).normalized()));
}

std::shared_ptr<const sim::Phantom> solids(std::vector<sim::Solid> parts) {
  return std::make_shared<sim::SolidPhantom>(std::move(parts));
}

/// Label 1 where a rule holds, in a tilted frame; the rule holds nowhere out of -half..half of that frame.
template <class Inside>
std::shared_ptr<const sim::Phantom> tilted_formula(const Vector3d& half, Inside inside) {
  const Vector3d reach = tilted().linear().cwiseAbs() * half;
  return std::make_shared<Formula>(Eigen::AlignedBox3d(-reach, reach), [=](const Vector3d& p) -> sim::Label {
    return inside(Vector3d(tilted().inverse() * p)) ? 1 : sim::kOutside;
  });
}

std::shared_ptr<const sim::Phantom> cone(double radius, double height) {
  return tilted_formula({radius, radius, height / 2}, [=](const Vector3d& p) {
    const double from_tip = height / 2 - p.z();
    return from_tip >= 0 && from_tip <= height && std::hypot(p.x(), p.y()) <= radius * from_tip / height;
  });
}

/// Circles across z whose centres move by `lean` along x for each step along z.
std::shared_ptr<const sim::Phantom> oblique_cylinder(double radius, double height, double lean) {
  return tilted_formula({radius + lean * height / 2, radius, height / 2}, [=](const Vector3d& p) {
    return std::abs(p.z()) <= height / 2 && std::hypot(p.x() - lean * p.z(), p.y()) <= radius;
  });
}

}  // namespace

std::vector<NamedBody> bodies_of_one_label() {
  return {{"sphere", solids({sim::sphere({0, 0, 0}, 40, 1)})},
          {"ellipsoid", solids({sim::ellipsoid(tilted(), {50, 32, 20}, 1)})},
          {"torus", solids({sim::torus(tilted(), 34, 13, 1)})},
          {"cone", cone(34, 80)},
          {"oblique cylinder", oblique_cylinder(20, 80, 0.5)},
          {"branching tube",
           solids({sim::capsule({2, -3, -45}, {0, 0, 0}, 10, 1), sim::capsule({0, 0, 0}, {-28, 9, 40}, 8, 1),
                   sim::capsule({0, 0, 0}, {30, -6, 36}, 7, 1)})},
          {"thin slab", solids({sim::box(tilted(), {46, 34, 4}, 1)})}};
}

NamedBody body_of_three_labels() {
  const Vector3d half(50, 40, 36);
  const auto label_at = [half](const Vector3d& p) -> sim::Label {
    if (p.cwiseQuotient(half).squaredNorm() > 1) return sim::kOutside;
    if ((p - Vector3d(8, -4, 6)).norm() <= 16) return 3;
    const double above_wall = 0.9 * p.x() + 0.3 * p.y() + 0.3 * p.z() - 5 * std::sin(p.y() / 9) * std::cos(p.z() / 11);
    return above_wall < 0 ? 1 : 2;
  };
  return {"three labels", std::make_shared<Formula>(Eigen::AlignedBox3d(-half, half), label_at)};
}

}  // namespace sonoloft::test
