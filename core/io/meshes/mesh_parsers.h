#pragma once
// The formats that read_mesh() tells apart. Each is given the whole file, and its name for messages.
#include <string>
#include <string_view>

#include "core/mesh/mesh.h"
#include "core/slice/result.h"

namespace sonoloft {

[[nodiscard]] Result<IndexedMesh> parse_ply(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<IndexedMesh> parse_stl(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<IndexedMesh> parse_obj(std::string_view text, const std::string& name);
[[nodiscard]] Result<IndexedMesh> parse_off(std::string_view text, const std::string& name);

}  // namespace sonoloft
