#include "host/apps/tool/method_choice.h"

namespace sonoloft::tool {

void add_method(CLI::App& verb, MethodChoice& choice, const std::vector<std::string>& not_with) {
  std::vector<std::string> names;
  std::string words = "Another published method instead of the live one:", option_words = "NAME=VALUE of the method:";
  for (const Method& method : methods()) {
    names.emplace_back(method.name);
    words += (names.size() > 1 ? "; " : " ") + names.back() + " (" + std::string(method.takes) + ")";
    for (const MethodOption& option : method.options)
      option_words += " " + std::string(option.name) + ", " + std::string(option.help) + " (" + names.back() + ");";
  }
  option_words.pop_back();
  auto* method = verb.add_option_function<std::string>(
                         "--method", [&choice](const std::string& name) { choice.method = find_method(name); }, words)
                     ->check(CLI::IsMember(names));
  verb.add_option("--method-option", choice.options, option_words)->needs(method)->allow_extra_args(false);
  for (const std::string& option : not_with) method->excludes(verb.get_option(option));
  verb.parse_complete_callback([&choice] {
    if (choice.method == nullptr) return;
    if (const auto settings = settings_of(*choice.method, choice.options); !settings)
      throw CLI::ValidationError("--method-option", settings.error().message);
  });
}

Result<MethodSurfaces> reconstruct_by(const MethodChoice& choice, std::span<const TrackedSlice> slices,
                                      double spacing_mm, int threads) {
  auto settings = settings_of(*choice.method, choice.options);
  if (!settings) return tl::unexpected<Error>(settings.error());
  return choice.method->run({slices, spacing_mm, threads, std::move(*settings)});
}

}  // namespace sonoloft::tool
