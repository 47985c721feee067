#include "core/methods/catalogue.h"

#include <algorithm>
#include <vector>

#include "core/methods/equal_importance/equal_importance.h"
#include "core/methods/medial_axis/medial_axis.h"
#include "core/methods/metamorphosis/metamorphosis.h"
#include "core/methods/straight_skeleton/straight_skeleton.h"

namespace sonoloft {
namespace {

template <class Names>
std::string list(const Names& names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

}  // namespace

std::span<const Method> methods() {
  static const std::vector<Method> all{equal_importance_method(), medial_axis_method(), metamorphosis_method(),
                                       straight_skeleton_method()};
  return all;
}

const Method* find_method(std::string_view name) {
  const auto found = std::ranges::find(methods(), name, &Method::name);
  return found == methods().end() ? nullptr : &*found;
}

Result<MethodSettings> settings_of(const Method& method, std::span<const std::string> texts) {
  MethodSettings settings;
  std::vector<std::string_view> names;
  for (const MethodOption& option : method.options) {
    settings.emplace(option.name, option.standard);
    names.push_back(option.name);
  }
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const std::string name = text.substr(0, equals), value = text.substr(std::min(equals + 1, text.size()));
    const auto option = std::ranges::find(method.options, name, &MethodOption::name);
    if (option == method.options.end())
      return fail(ErrorCode::invalid_argument,
                  std::string(method.name) + " has no option '" + name + "': it has " + list(names));
    if (!option->values.empty() && std::ranges::find(option->values, value) == option->values.end())
      return fail(ErrorCode::invalid_argument, "'" + value + "' is no " + name + ": give " + list(option->values));
    settings[name] = value;
  }
  return settings;
}

}  // namespace sonoloft
