#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/methods/catalogue.h"

namespace sonoloft::tool {

/// Another way than the live one to make surfaces of recorded slices.
struct MethodChoice {
  const Method* method = nullptr;    ///< null: the live one
  std::vector<std::string> options;  ///< of the method, "name=value"
};

/// --method, --method-option. Those of the live way in `not_with` do not go with them.
void add_method(CLI::App& verb, MethodChoice& choice, const std::vector<std::string>& not_with);

/// @error those of settings_of() and of the method
[[nodiscard]] Result<MethodSurfaces> reconstruct_by(const MethodChoice& choice, std::span<const TrackedSlice> slices,
                                                    double spacing_mm, int threads);

}  // namespace sonoloft::tool
