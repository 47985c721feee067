#pragma once
#include <cmath>
#include <cstdint>

namespace sonoloft::skeleton {

/// What a rational number is modulo the prime 2^61 - 1. Numbers that are equal have the same residue; others have it by
/// an accident of 1 in 2^61. So equality needs no long arithmetic, and a name can be made of it.
class Residue {
 public:
  Residue() = default;
  explicit Residue(double x) {
    int exponent = 0;
    const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
    const auto size = static_cast<std::uint64_t>(mantissa < 0 ? -mantissa : mantissa);
    const int shift = ((exponent - 53) % 61 + 61) % 61;  // 2^61 is 1
    *this = of(size) * of(std::uint64_t{1} << shift);
    if (mantissa < 0) *this = Residue() - *this;
  }

  [[nodiscard]] bool is_zero() const { return value_ == 0; }
  [[nodiscard]] std::uint64_t value() const { return value_; }
  [[nodiscard]] Residue inverse() const {  // x^(p - 2)
    Residue power = of(1), square = *this;
    for (std::uint64_t e = kPrime - 2; e != 0; e >>= 1, square = square * square)
      if ((e & 1) != 0) power = power * square;
    return power;
  }

  friend Residue operator+(Residue a, Residue b) { return of(a.value_ + b.value_); }
  friend Residue operator-(Residue a, Residue b) { return of(a.value_ + kPrime - b.value_); }
  friend Residue operator*(Residue a, Residue b) {
    __extension__ using Wide = unsigned __int128;
    const Wide product = Wide{a.value_} * b.value_;
    return of((static_cast<std::uint64_t>(product) & kPrime) + static_cast<std::uint64_t>(product >> 61));
  }
  friend auto operator<=>(Residue, Residue) = default;

 private:
  static constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;
  /// @param x  below 2^62
  static Residue of(std::uint64_t x) {
    Residue r;
    r.value_ = x >= kPrime ? x - kPrime : x;
    return r;
  }
  std::uint64_t value_ = 0;
};

}  // namespace sonoloft::skeleton
