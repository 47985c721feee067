#include "tests/integration/igtl/program.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

namespace sonoloft::test {
namespace {

/// @return false: it is not so within any sensible time
bool wait_until(const std::function<bool()>& so) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(90);
  while (!so()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace

Program::Program(std::vector<std::string> command) {
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::string file = folder_.path("printed").string();
  pid_ = fork();
  REQUIRE(pid_ >= 0);
  if (pid_ > 0) return;
  const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  execvp(arguments[0], arguments.data());
  _exit(127);
}

Program::~Program() {
  if (ended_) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

std::string Program::printed() const {
  std::ifstream file(folder_.path("printed"), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool Program::wait_for(const std::function<bool(const std::string& printed)>& so) const {
  return wait_until([&] { return so(printed()); });
}

void Program::freeze() const {
  REQUIRE(kill(pid_, SIGSTOP) == 0);
}

bool Program::wait_end() {
  ended_ = wait_until([&] { return waitpid(pid_, nullptr, WNOHANG) == pid_; });
  return ended_;
}

}  // namespace sonoloft::test
