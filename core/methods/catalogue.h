#pragma once
#include <span>
#include <string>

#include "core/methods/method.h"

namespace sonoloft {

/// All methods, ascending by name.
[[nodiscard]] std::span<const Method> methods();

/// Null when there is none of that name.
[[nodiscard]] const Method* find_method(std::string_view name);

/// Every option of a method: what "name=value" says, else its standard.
/// @error invalid_argument (no such option or value: the message lists those that are)
[[nodiscard]] Result<MethodSettings> settings_of(const Method& method, std::span<const std::string> texts);

}  // namespace sonoloft
