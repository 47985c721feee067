#include "device_sim/probe/phantoms/torso_phantom.h"

#include <cmath>
#include <numbers>

namespace sonoloft::device_sim {
namespace {

constexpr Label label(Torso part) {
  return static_cast<Label>(part);
}

/// The front of a ring around the body, which falls to both sides.
void add_rib(double z_mm, std::vector<Solid>& solids) {
  constexpr double kRing_mm = 80, kTube_mm = 5, kFall = 0.2;
  constexpr int kPieces = 6;
  constexpr double kHalfAngle = 53 * std::numbers::pi / 180;
  const auto on_rib = [&](int i) {
    const double angle = kHalfAngle * (2.0 * i / kPieces - 1);
    const double x = kRing_mm * std::sin(angle);
    return Eigen::Vector3d(x, kTube_mm + kRing_mm * (1 - std::cos(angle)), z_mm - kFall * std::abs(x));
  };
  for (int i = 0; i < kPieces; ++i) solids.push_back(capsule(on_rib(i), on_rib(i + 1), kTube_mm, label(Torso::bone)));
}

void add_organs(std::vector<Solid>& solids) {
  const auto turned = [](const Eigen::Vector3d& centre_mm, double angle_rad, const Eigen::Vector3d& axis) {
    return Eigen::Isometry3d(Eigen::Translation3d(centre_mm) * Eigen::AngleAxisd(angle_rad, axis.normalized()));
  };
  solids.push_back(ellipsoid(turned({-8, 50, 0}, 0.25, {1, 1, 2}), {48, 28, 62}, label(Torso::liver)));
  solids.push_back(ellipsoid(turned({34, 66, -42}, -0.3, {0, 1, 1}), {18, 15, 28}, label(Torso::kidney)));
  solids.push_back(sphere({-30, 44, 22}, 9, label(Torso::tumour)));
}

void add_vessels(std::vector<Solid>& solids) {
  const struct {
    Eigen::Vector3d from, to;
    double radius_mm;
  } pieces[] = {{{26, 74, -30}, {0, 56, -8}, 4},   {{0, 56, -8}, {-22, 50, 6}, 3},     {{0, 56, -8}, {6, 48, 34}, 2.5},
                {{-22, 50, 6}, {-44, 42, -14}, 2}, {{-22, 50, 6}, {-30, 56, 40}, 1.5}, {{6, 48, 34}, {22, 42, 50}, 1.5},
                {{0, 56, -8}, {-14, 36, -34}, 2}};
  for (const auto& piece : pieces)
    solids.push_back(capsule(piece.from, piece.to, piece.radius_mm, label(Torso::vessel)));
}

}  // namespace

SolidPhantom torso_phantom() {
  std::vector<Solid> solids;
  for (const double z_mm : {-57, -31, -5, 21, 47, 73}) add_rib(z_mm, solids);
  solids.push_back(capsule({0, 112, -68}, {0, 112, 64}, 14, label(Torso::bone)));
  add_organs(solids);
  add_vessels(solids);
  return SolidPhantom(std::move(solids));
}

}  // namespace sonoloft::device_sim
