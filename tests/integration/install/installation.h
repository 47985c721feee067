#pragma once
#include <filesystem>
#include <string>

namespace sonoloft::test {

struct Ran {
  int status;
  std::string output;  ///< of both streams
};

/// What a shell does with these lines; the first that fails ends it.
[[nodiscard]] Ran run(const std::string& lines);

/// The text of a file. @pre it exists
[[nodiscard]] std::string text_of(const std::filesystem::path& path);

/// What stands between ```<language> and ``` in a document, one after the other.
[[nodiscard]] std::string code_in(const std::string& document, const std::string& language);

/// A folder in which the commands of docs/sdk.md have run, once for all tests. Its home has the installation.
[[nodiscard]] const std::filesystem::path& guided_folder();
[[nodiscard]] inline std::filesystem::path prefix() {
  return guided_folder() / "sonoloft";
}

}  // namespace sonoloft::test
