#include "core/tracking/bottom_line.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace sonoloft {
namespace {

constexpr std::uint32_t kColumnStep = 4;
constexpr std::uint32_t kHalfWindow = 3;  // rows that are averaged on either side
constexpr double kAgreement = 0.05;       // of the height: columns farther off the line than this disagree
constexpr double kAgreeingShare = 0.5;
constexpr double kLeastBrightness = 16;  // of 255: below it a column shows nothing

/// The row of the brightest window of a column; nothing where all is dark.
std::optional<double> brightest_row(std::span<const std::uint8_t> image, std::uint32_t width, std::uint32_t height,
                                    std::uint32_t column) {
  const std::uint32_t window = 2 * kHalfWindow + 1;
  std::uint32_t sum = 0, best = 0, best_row = 0;
  for (std::uint32_t row = 0; row < height; ++row) {
    sum += image[std::size_t{row} * width + column];
    if (row >= window) sum -= image[std::size_t{row - window} * width + column];
    if (sum <= best) continue;
    best = sum;
    best_row = row;
  }
  if (best < kLeastBrightness * window) return std::nullopt;
  return static_cast<double>(best_row) - kHalfWindow;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<double> bottom_line(std::span<const std::uint8_t> image, std::uint32_t width, std::uint32_t height) {
  std::vector<double> rows;
  std::uint32_t columns = 0;
  for (std::uint32_t column = width / 4; column < width - width / 4; column += kColumnStep, ++columns) {
    if (const auto row = brightest_row(image, width, height, column)) rows.push_back(*row);
  }
  if (rows.empty()) return std::nullopt;
  const double line = median(rows);
  const auto agreeing =
      std::count_if(rows.begin(), rows.end(), [&](double row) { return std::abs(row - line) < kAgreement * height; });
  if (static_cast<double>(agreeing) < kAgreeingShare * columns) return std::nullopt;
  return line;
}

}  // namespace

std::vector<std::optional<double>> bottom_lines(const ImageStack& images) {
  const auto [width, height, count] = images.dims;
  const std::size_t size = std::size_t{width} * height;
  std::vector<std::optional<double>> lines(count);
  for (std::size_t i = 0; size > 0 && i < count; ++i)
    lines[i] = bottom_line(std::span(images.pixels).subspan(i * size, size), width, height);
  return lines;
}

}  // namespace sonoloft
