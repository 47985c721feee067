#include "core/background/shadow_fill.h"

#include <algorithm>

namespace sonoloft {
namespace {

using Eigen::Vector2i;

// Measured on masked sections: larger shadows come out better from the slices around, and with more weight a guess
// outweighs these.
constexpr std::size_t kLargestShadow = 130;  ///< pixels: about 4 spacings across
constexpr std::uint8_t kFilledWeight = kPixelUnit / 4;

/// Unknown pixels that hang together, and the known ones around them.
struct Shadow {
  std::vector<Vector2i> inside, rim;
  bool enclosed = true;
};

class ShadowFill {
 public:
  explicit ShadowFill(SectionRaster raster) : raster_(std::move(raster)), visited_(raster_.label.size(), 0) {
    for (const Label label : raster_.label) weight_.push_back(label == kUnknown ? 0 : kPixelUnit);
  }

  FilledRaster run() && {
    FilledRaster out{raster_, std::move(weight_)};
    for (int y = 0; y < raster_.height; ++y)
      for (int x = 0; x < raster_.width; ++x) {
        if (raster_.at(x, y) != kUnknown || visited_[index({x, y})] != 0) continue;
        const Shadow shadow = shadow_at({x, y});
        if (shadow.enclosed && shadow.inside.size() <= kLargestShadow) fill(shadow, out);
      }
    return out;
  }

 private:
  [[nodiscard]] std::size_t index(const Vector2i& p) const {
    return static_cast<std::size_t>(p.x()) + static_cast<std::size_t>(p.y()) * static_cast<std::size_t>(raster_.width);
  }

  Shadow shadow_at(const Vector2i& start) {
    Shadow shadow;
    shadow.inside.push_back(start);
    visited_[index(start)] = 1;
    for (std::size_t i = 0; i < shadow.inside.size(); ++i) {
      const Vector2i p = shadow.inside[i];
      if (p.x() == 0 || p.y() == 0 || p.x() == raster_.width - 1 || p.y() == raster_.height - 1) {
        shadow.enclosed = false;
        continue;  // its neighbours of the rim are reached from within
      }
      for (const Vector2i& step : {Vector2i(-1, 0), Vector2i(1, 0), Vector2i(0, -1), Vector2i(0, 1)}) {
        const Vector2i q = p + step;
        if (raster_.label[index(q)] != kUnknown) {
          shadow.rim.push_back(q);
        } else if (visited_[index(q)] == 0) {
          visited_[index(q)] = 1;
          shadow.inside.push_back(q);
        }
      }
    }
    return shadow;
  }

  void fill(const Shadow& shadow, FilledRaster& out) {
    for (const Vector2i& p : shadow.inside) {
      out.raster.label[index(p)] = label_between(p, shadow.rim);
      out.weight[index(p)] = kFilledWeight;
    }
  }

  /// The label with the largest share of the harmonic function that fits the rim, lowest of equals; for discs and half
  /// planes that is the mean of the rim by 1 / distance^2 (Poisson).
  [[nodiscard]] Label label_between(const Vector2i& p, const std::vector<Vector2i>& rim) {
    votes_.clear();
    for (const Vector2i& q : rim) {
      const Label label = raster_.label[index(q)];
      auto it = std::find_if(votes_.begin(), votes_.end(), [&](const Vote& v) { return v.label == label; });
      if (it == votes_.end()) it = votes_.insert(it, {label, 0});
      it->weight += 1.0 / (q - p).squaredNorm();
    }
    return std::max_element(votes_.begin(), votes_.end(),
                            [](const Vote& a, const Vote& b) {
                              return a.weight < b.weight || (a.weight == b.weight && a.label > b.label);
                            })
        ->label;
  }

  struct Vote {
    Label label;
    double weight;
  };
  SectionRaster raster_;
  std::vector<std::uint8_t> weight_, visited_;
  std::vector<Vote> votes_;
};

}  // namespace

FilledRaster fill_shadows(SectionRaster raster) {
  return ShadowFill(std::move(raster)).run();
}

}  // namespace sonoloft
