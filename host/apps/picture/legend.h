#pragma once
#include "host/apps/picture/picture.h"

namespace sonoloft {

/// Writes the lines into the lower left corner, each behind a square of its label's colour.
void draw_legend(const PictureOptions& options, Picture& picture);

}  // namespace sonoloft
