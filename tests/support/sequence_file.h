#pragma once
// Sequences of tracked images as PLUS writes them, made up by tests.
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace sonoloft::test {

using Fields = std::vector<std::pair<std::string, std::string>>;

inline constexpr const char* kUnitMatrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

/// The fields of a frame: a transform with its status, a time, whether the image is good.
inline Fields frame_fields(int index, const std::string& matrix, const std::string& time = "1",
                           const std::string& status = "OK", const std::string& transform = "ProbeToTracker") {
  char prefix[32];
  std::snprintf(prefix, sizeof prefix, "Seq_Frame%04d_", index);
  return {{prefix + transform + "Transform", matrix},
          {prefix + transform + "TransformStatus", status},
          {prefix + std::string("Timestamp"), time},
          {prefix + std::string("ImageStatus"), "OK"}};
}

/// @param before  besides the dims and the type
inline std::string meta_image(const std::string& dims, const Fields& fields, const std::string& pixels,
                              const Fields& before = {}, const std::string& type = "MET_UCHAR") {
  std::string text = "ObjectType = Image\nNDims = 3\nDimSize = " + dims + "\nElementType = " + type + '\n';
  for (const Fields& part : {before, fields})
    for (const auto& [key, value] : part) text += key + " = " + value + '\n';
  return text + "ElementDataFile = LOCAL\n" + pixels;
}

inline std::string nrrd(const std::string& sizes, const Fields& fields, const std::string& pixels,
                        const std::string& header = "encoding: raw\nkinds: domain domain list\n",
                        const std::string& type = "unsigned char") {
  std::string text = "NRRD0005\n# made up\ntype: " + type + "\ndimension: 3\nsizes: " + sizes + '\n' + header;
  for (const auto& [key, value] : fields) text += key + ":=" + value + '\n';
  return text + '\n' + pixels;
}

}  // namespace sonoloft::test
