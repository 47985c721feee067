#include "core/background/shadow_fill.h"

namespace sonoloft {

FilledRaster fill_shadows(SectionRaster raster) {
  FilledRaster out{std::move(raster), {}};
  for (const Label label : out.raster.label) out.weight.push_back(label == kUnknown ? 0 : kPixelUnit);
  return out;
}

}  // namespace sonoloft
