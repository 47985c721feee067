#include "host/apps/tool/interrupt.h"

#include <csignal>

namespace sonoloft::tool {
namespace {

volatile std::sig_atomic_t noted = 0;

void note(int signal) {
  noted = 1;
  std::signal(signal, SIG_DFL);  // a second Ctrl-C means it
}

}  // namespace

void note_interrupts() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

bool interrupted() {
  return noted != 0;
}

}  // namespace sonoloft::tool
