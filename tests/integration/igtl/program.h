#pragma once
#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace sonoloft::test {

/// A program that runs as a process of its own.
class Program {
 public:
  /// @param command  program and arguments
  explicit Program(std::vector<std::string> command);
  ~Program();  ///< kills it
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// What it has printed so far, on both streams.
  [[nodiscard]] std::string printed() const;
  /// Waits until that is so. @return false: it never is
  [[nodiscard]] bool wait_for(const std::function<bool(const std::string& printed)>& so) const;
  void freeze() const;            ///< it is stopped, and knows nothing of it
  [[nodiscard]] bool wait_end();  ///< @return false: it never ends

 private:
  TemporaryFolder folder_;
  pid_t pid_;
  bool ended_ = false;
};

}  // namespace sonoloft::test
