#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb/stb_image_write.h>

#include "host/apps/picture/picture.h"

namespace sonoloft {

Result<void> write_png(const Picture& picture, const std::filesystem::path& path) {
  if (stbi_write_png(path.c_str(), picture.width_px, picture.height_px, 3, picture.rgb.data(), 3 * picture.width_px) ==
      0) {
    return fail(ErrorCode::io_failed,
                "cannot write the picture " + path.string() + ": check the folder, its rights and free space");
  }
  return {};
}

}  // namespace sonoloft
