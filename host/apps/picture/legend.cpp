#include "host/apps/picture/legend.h"

#include <stb/stb_easy_font.h>

#include <algorithm>
#include <array>

namespace sonoloft {
namespace {

struct Rect {
  int left, top, width, height;
};

void fill(Picture& picture, const Rect& rect, const Rgb& color) {
  for (int y = std::max(0, rect.top); y < std::min(picture.height_px, rect.top + rect.height); ++y) {
    for (int x = std::max(0, rect.left); x < std::min(picture.width_px, rect.left + rect.width); ++x) {
      std::copy(color.begin(), color.end(),
                picture.rgb.begin() + 3 * (std::ptrdiff_t{x} + std::ptrdiff_t{picture.width_px} * y));
    }
  }
}

/// A corner of one of the font's rectangles, as the font library writes them.
struct FontVertex {
  float x, y, z;
  std::array<std::uint8_t, 4> color;
};
static_assert(sizeof(FontVertex) == 16);

void write(Picture& picture, std::string text, int left, int top, int scale, const Rgb& color) {
  // The font has the printable ASCII letters only and reads beyond its table for others.
  for (char& letter : text) letter = letter >= ' ' && letter <= '~' ? letter : '?';
  std::vector<FontVertex> corners(4 * 70 * (text.size() + 1));  // more than any letter has rectangles
  const int count = stb_easy_font_print(0, 0, text.data(), nullptr, corners.data(),
                                        static_cast<int>(corners.size() * sizeof(FontVertex)));
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const FontVertex &a = corners[4 * i], &c = corners[4 * i + 2];
    fill(picture,
         {left + scale * static_cast<int>(a.x), top + scale * static_cast<int>(a.y),
          scale * static_cast<int>(c.x - a.x), scale * static_cast<int>(c.y - a.y)},
         color);
  }
}

}  // namespace

void draw_legend(const PictureOptions& options, Picture& picture) {
  const int scale = std::max(1, picture.height_px / 450);
  const int line = 14 * scale, square = 8 * scale, margin = 10 * scale;
  int top = picture.height_px - margin - line * static_cast<int>(options.legend.size());
  for (const LegendLine& entry : options.legend) {
    fill(picture, {margin, top, square, square}, options.labels.colour(entry.label));
    const Rgb ink = options.dark ? Rgb{214, 218, 224} : Rgb{52, 56, 64};
    write(picture, entry.text, margin + square + 6 * scale, top + scale / 2, scale, ink);
    top += line;
  }
}

}  // namespace sonoloft
