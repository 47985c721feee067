// The tests print, read golden files and exit over the emulator.
#include <cstdlib>

extern "C" {
void initialise_monitor_handles();
void before_main() {
  initialise_monitor_handles();
}
[[noreturn]] void after_main(int status) {
  std::exit(status);
}
void _init() {}
void _fini() {}
}
