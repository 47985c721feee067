#include "core/methods/straight_skeleton/exact/form.h"

#include <algorithm>

namespace sonoloft::skeleton {
namespace {

/// A part of the doubt below which rough values are not relied on.
constexpr double kRoundedTo = 1e-2;

using Bounds = CGAL::Interval_nt<false>;

/// Where three planes meet: x, y, z, times the fourth.
template <class Of, class Get>
std::array<Of, 4> meeting(const Form& f, const Form& g, const Form& h, const Get& get) {
  using Four = std::array<Of, 4>;
  const auto of = [&](const Form& form) {
    return Four{get(form.c[0]), get(form.c[1]), get(form.c[2]), get(form.c[3])};
  };
  const auto cross = [](const Four& a, const Four& b) {
    return std::array<Of, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const Four a = of(f), b = of(g), c = of(h);
  const auto bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  Four out{Of(0), Of(0), Of(0), Of(0)};
  for (std::size_t i = 0; i < 3; ++i) out[i] = a[3] * bc[i] + b[3] * ca[i] + c[3] * ab[i];
  out[3] = Of(0) - (a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2]);
  return out;
}

}  // namespace

Corner::Corner(const std::array<Exact, 3>& p)
    : residues_{p[0].residue, p[1].residue, p[2].residue, Residue(1)},
      given_(std::make_shared<const Triple>(Triple{settled(p[0].value), settled(p[1].value), settled(p[2].value)})) {
  rough = canonical(*given_);
}

Corner::Corner(const FormPtr& f, const FormPtr& g, const FormPtr& h, double doubt_mm) : planes_{f, g, h} {
  residues_ = meeting<Residue>(*f, *g, *h, [](const Exact& x) { return x.residue; });
  std::array<Bounds, 3> near{Bounds(0), Bounds(0), Bounds(0)};
  {
    const Bounds::Protector rounding;
    const std::array<Bounds, 4> of = meeting<Bounds>(*f, *g, *h, [](const Exact& x) { return x.value.approx(); });
    for (std::size_t i = 0; i < 3; ++i) near[i] = of[i] / of[3];
  }
  const bool is_near = std::ranges::all_of(near, [&](const Bounds& b) {
    return b.sup() - b.inf() <= kRoundedTo * doubt_mm;  // never where they are no numbers
  });
  if (is_near)
    for (std::size_t i = 0; i < 3; ++i) rough[static_cast<Eigen::Index>(i)] = 0.5 * (near[i].inf() + near[i].sup());
  else
    rough = canonical(at());
}

Corner Corner::middle(std::vector<Corner> of) {
  Corner middle;
  const Residue part = Residue(static_cast<double>(of.size())).inverse();
  middle.residues_[3] = Residue(1);
  for (const Corner& c : of) {
    const std::array<Residue, 3> name = c.name();
    for (std::size_t i = 0; i < 3; ++i) middle.residues_[i] = middle.residues_[i] + part * name[i];
    middle.rough += c.rough / static_cast<double>(of.size());
  }
  middle.around_ = std::make_shared<const std::vector<Corner>>(std::move(of));
  return middle;
}

Triple Corner::at() const {
  if (given_) return *given_;
  if (around_) {
    Triple sum{Number(0), Number(0), Number(0)};
    for (const Corner& c : *around_) {
      const Triple at = c.at();
      for (std::size_t i = 0; i < 3; ++i) sum[i] += at[i] / static_cast<double>(around_->size());
    }
    return sum;
  }
  const auto of = meeting<Number>(*planes_[0], *planes_[1], *planes_[2], [](const Exact& x) { return x.value; });
  return {of[0] / of[3], of[1] / of[3], of[2] / of[3]};
}

bool Corner::is_at(const Corner& other) const {
  for (std::size_t i = 0; i < 3; ++i)
    if (residues_[i] * other.residues_[3] != other.residues_[i] * residues_[3]) return false;
  return true;
}

std::array<Residue, 3> Corner::name() const {
  const Residue unit = residues_[3].inverse();
  return {residues_[0] * unit, residues_[1] * unit, residues_[2] * unit};
}

Form::Form(const std::array<Exact, 4>& of) {
  for (std::size_t i = 0; i < 4; ++i) {
    c[i] = {settled(of[i].value), of[i].residue};
    rough[static_cast<Eigen::Index>(i)] = CGAL::to_double(c[i].value.exact());
  }
}

Residue Form::residue_at(const Corner& p) const {
  Residue sum;
  for (std::size_t i = 0; i < 4; ++i) sum = sum + c[i].residue * p.residues()[i];
  return sum;
}

bool Form::is_zero() const {
  return std::ranges::all_of(c, [](const Exact& x) { return x.residue.is_zero(); });
}

FormPtr sum(const Form& f, const Exact& t, const Form& g) {
  std::array<Exact, 4> of;
  for (std::size_t i = 0; i < 4; ++i) of[i] = f.c[i] + t * g.c[i];
  return std::make_shared<const Form>(of);
}

int side_of(const Form& plane, const Corner& p, double doubt_mm) {
  const double at = plane.near(p.rough);
  if (std::abs(at) > doubt_mm) return at > 0 ? 1 : -1;
  return plane.is_zero_at(p) ? 0 : network::sign_of(plane.at(p.at()));
}

int ratio_sign(const Form& f, const Form& g) {
  Eigen::Index k = 0;
  g.rough.cwiseAbs().maxCoeff(&k);
  const auto& pivot = static_cast<std::size_t>(k);
  if (f.c[pivot].residue.is_zero()) return 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (!(f.c[i].residue * g.c[pivot].residue - g.c[i].residue * f.c[pivot].residue).is_zero()) return 0;
  return sign_of(f.c[pivot]) * sign_of(g.c[pivot]);
}

LineName name_of_line(const Form& f, const Form& g) {
  LineName name;
  std::size_t at = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = i + 1; k < 4; ++k)
      name[at++] = f.c[i].residue * g.c[k].residue - f.c[k].residue * g.c[i].residue;
  const auto pivot = std::ranges::find_if(name, [](Residue r) { return !r.is_zero(); });
  const Residue unit = pivot->inverse();
  for (Residue& r : name) r = r * unit;
  return name;
}

}  // namespace sonoloft::skeleton
