#include "core/segmentation/bone_segmentation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sonoloft {
namespace {

constexpr double kWide_mm = 1.3, kHigh_mm = 0.6;  // of the window that echoes are averaged over, and lines
constexpr double kGap_mm = 3;                     // the echo of the line itself reaches down so far
constexpr double kThick_mm = 2;                   // what is called bone
constexpr float kLeast = 30;                      // grey levels above all that is below
constexpr float kPerPixel = 5;                    // grey levels that a step of a pixel from column to column costs
constexpr int kSteepest = 4;                      // pixels from column to column

int pixels(double mm, double mm_per_pixel) {
  return std::max(1, static_cast<int>(std::lround(mm / mm_per_pixel)));
}

/// Floats for the pixels of an image, column by column.
struct Columns {
  int width, height;
  std::vector<float> value;  ///< [width][height]

  Columns(int w, int h) : width(w), height(h), value(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0) {}
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(height) + static_cast<std::size_t>(y);
  }
  [[nodiscard]] float at(int x, int y) const { return value[index(x, y)]; }
  float& at(int x, int y) { return value[index(x, y)]; }
};

/// The mean over windows of 2 half_x + 1 by 2 half_y + 1 pixels; at the border, over what there is of them.
Columns averaged(const GreyImage& image, int half_x, int half_y) {
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  std::vector<std::uint32_t> sums(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1), 0);
  const auto sum = [&](int x, int y) -> std::uint32_t& {
    return sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(width + 1) + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      sum(x + 1, y + 1) = sum(x, y + 1) + sum(x + 1, y) - sum(x, y) +
                          image.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  Columns mean(width, height);
  for (int x = 0; x < width; ++x) {
    const int x0 = std::max(0, x - half_x), x1 = std::min(width, x + half_x + 1);
    for (int y = 0; y < height; ++y) {
      const int y0 = std::max(0, y - half_y), y1 = std::min(height, y + half_y + 1);
      const std::uint32_t all = sum(x1, y1) - sum(x0, y1) - sum(x1, y0) + sum(x0, y0);
      mean.at(x, y) = static_cast<float>(all) / static_cast<float>((x1 - x0) * (y1 - y0));
    }
  }
  return mean;
}

/// How far every echo stands out from the brightest one below it, less what bone must. Neither what touches the
/// transducer nor what has nothing below it can be bone.
Columns echo_over_shadow(const Columns& echo, int gap) {
  Columns score(echo.width, echo.height);
  for (int x = 0; x < echo.width; ++x) {
    float below = 0;
    for (int y = echo.height - 1; y >= 0; --y) {
      if (y + gap < echo.height) below = std::max(below, echo.at(x, y + gap));
      const bool possible = y >= gap && y + gap < echo.height && echo.at(x, y) > below;
      score.at(x, y) = possible ? echo.at(x, y) - below - kLeast : -std::numeric_limits<float>::infinity();
    }
  }
  return score;
}

struct Line {
  int first_column = 0;
  std::vector<int> rows;  ///< one a column; none: there is no line
};

/// The line over neighbouring columns whose scores have the largest sum, less what its steps cost.
Line best_line(const Columns& score) {
  constexpr int kBegins = std::numeric_limits<int>::min();
  Columns total = score;
  std::vector<int> came_from(score.value.size(), kBegins);
  float best = 0;
  int last_column = -1, row = 0;
  for (int x = 0; x < score.width; ++x) {
    for (int y = 0; y < score.height; ++y) {
      float before = 0;
      for (int step = -kSteepest; x > 0 && step <= kSteepest; ++step) {
        if (y + step < 0 || y + step >= score.height) continue;
        const float sum = total.at(x - 1, y + step) - kPerPixel * static_cast<float>(std::abs(step));
        if (sum <= before) continue;
        before = sum;
        came_from[score.index(x, y)] = y + step;
      }
      total.at(x, y) = score.at(x, y) + before;
      if (total.at(x, y) <= best) continue;
      best = total.at(x, y);
      last_column = x;
      row = y;
    }
  }
  Line line{last_column, {}};
  for (; last_column >= 0 && row != kBegins; --line.first_column) {
    line.rows.push_back(row);
    row = came_from[score.index(line.first_column, row)];
  }
  ++line.first_column;
  std::ranges::reverse(line.rows);
  return line;
}

/// The line without what a column has by itself: the mean over 2 half + 1 columns, at the ends over what there is.
Line smoothed(const Line& line, int half) {
  Line smooth = line;
  const int count = static_cast<int>(line.rows.size());
  for (int i = 0; i < count; ++i) {
    const int reach = std::min({half, i, count - 1 - i});
    const auto middle = line.rows.begin() + i;
    const double sum = std::accumulate(middle - reach, middle + reach + 1, 0.0);
    smooth.rows[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(sum / (2 * reach + 1)));
  }
  return smooth;
}

std::vector<Label> labelled(const GreyImage& image, const Line& line, int thick) {
  std::vector<Label> labels(image.pixels.size(), kUnknown);
  if (line.rows.empty()) return labels;
  const int last = static_cast<int>(line.rows.size()) - 1;
  for (int x = 0; x < static_cast<int>(image.width); ++x) {
    const int along = x - line.first_column;
    const int surface = line.rows[static_cast<std::size_t>(std::clamp(along, 0, last))];
    const int below = along >= 0 && along <= last ? surface + thick : surface;
    for (int y = 0; y < std::min(below, static_cast<int>(image.height)); ++y)
      labels[static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)] = y < surface ? kOutside : kBone;
  }
  return labels;
}

}  // namespace

std::vector<Label> segment_bone(const GreyImage& image, const Eigen::Vector2d& mm_per_pixel) {
  const int half_wide = pixels(kWide_mm, mm_per_pixel.x()) / 2;
  const Columns echo = averaged(image, half_wide, pixels(kHigh_mm, mm_per_pixel.y()) / 2);
  const Line line = best_line(echo_over_shadow(echo, pixels(kGap_mm, mm_per_pixel.y())));
  return labelled(image, smoothed(line, half_wide), pixels(kThick_mm, mm_per_pixel.y()));
}

}  // namespace sonoloft
