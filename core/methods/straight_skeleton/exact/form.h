#pragma once
#include <array>
#include <memory>
#include <vector>

#include "core/methods/network/exact.h"
#include "core/methods/straight_skeleton/exact/residue.h"

namespace sonoloft::skeleton {

using namespace network;

/// An exact number that knows whether it is zero without arithmetic.
struct Exact {
  Exact() = default;
  explicit Exact(double x) : value(x), residue(x) {}
  Exact(Number v, Residue r) : value(std::move(v)), residue(r) {}
  Number value;
  Residue residue;

  friend Exact operator+(const Exact& a, const Exact& b) { return {a.value + b.value, a.residue + b.residue}; }
  friend Exact operator-(const Exact& a, const Exact& b) { return {a.value - b.value, a.residue - b.residue}; }
  friend Exact operator*(const Exact& a, const Exact& b) { return {a.value * b.value, a.residue * b.residue}; }
  friend Exact operator/(const Exact& a, const Exact& b) {
    return {a.value / b.value, a.residue * b.residue.inverse()};
  }
};

[[nodiscard]] inline int sign_of(const Exact& x) {
  return x.residue.is_zero() ? 0 : static_cast<int>(CGAL::sign(x.value));
}

struct Form;
using FormPtr = std::shared_ptr<const Form>;

/// A point of space, mm. It knows its residues, and its place in doubles; exact numbers are made when they are asked
/// for.
class Corner {
 public:
  Corner() : rough(0, 0, 0) {}
  explicit Corner(const std::array<Exact, 3>& at);
  /// Where three planes meet. @pre they do, in one point
  Corner(const FormPtr& f, const FormPtr& g, const FormPtr& h, double doubt_mm);

  [[nodiscard]] static Corner middle(std::vector<Corner> of);

  [[nodiscard]] Triple at() const;
  [[nodiscard]] bool is_at(const Corner& other) const;
  [[nodiscard]] std::array<Residue, 3> name() const;
  [[nodiscard]] const std::array<Residue, 4>& residues() const { return residues_; }  ///< times a common factor

  Eigen::Vector3d rough;

 private:
  std::array<Residue, 4> residues_;
  // one of these
  std::array<FormPtr, 3> planes_;
  std::shared_ptr<const Triple> given_;
  std::shared_ptr<const std::vector<Corner>> around_;
};

/// a x + b y + c z + d: a plane is where it is 0. Gradients are about 1, so that values are about mm.
struct Form {
  Form() : rough(0, 0, 0, 0) {}
  explicit Form(const std::array<Exact, 4>& of);
  std::array<Exact, 4> c;
  Eigen::Vector4d rough;

  [[nodiscard]] Number at(const Triple& p) const {
    return c[0].value * p[0] + c[1].value * p[1] + c[2].value * p[2] + c[3].value;
  }
  [[nodiscard]] double near(const Eigen::Vector3d& p) const { return rough.head<3>().dot(p) + rough.w(); }
  /// Times the factor of the point's residues.
  [[nodiscard]] Residue residue_at(const Corner& p) const;
  [[nodiscard]] bool is_zero_at(const Corner& p) const { return residue_at(p).is_zero(); }
  [[nodiscard]] bool is_zero() const;
};

/// f + t g
[[nodiscard]] FormPtr sum(const Form& f, const Exact& t, const Form& g);
[[nodiscard]] inline FormPtr difference(const Form& f, const Form& g) {
  return sum(f, Exact(-1), g);
}
[[nodiscard]] inline FormPtr negative(const Form& f) {
  return sum(Form(), Exact(-1), f);
}

/// On which side of a plane a point is, exactly. @param doubt_mm  what a rough value must exceed to be sure
[[nodiscard]] int side_of(const Form& plane, const Corner& p, double doubt_mm);

/// +1, -1: one form is a positive or negative multiple of the other one; 0: it is none, or zero.
[[nodiscard]] int ratio_sign(const Form& f, const Form& g);

/// The line in which two planes meet.
using LineName = std::array<Residue, 6>;
[[nodiscard]] LineName name_of_line(const Form& f, const Form& g);

}  // namespace sonoloft::skeleton
