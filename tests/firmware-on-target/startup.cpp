// From reset to main() on a Cortex-M7, for the image and for the tests.
#include <algorithm>
#include <cstdint>

extern "C" {
extern std::uint32_t data_begin[], data_end[], data_in_flash[], bss_begin[], bss_end[], stack_top[];
extern void (*__init_array_start[])();
extern void (*__init_array_end[])();
int program() asm("main");
void before_main();
[[noreturn]] void after_main(int status);
void* __dso_handle = nullptr;

[[noreturn]] void reset() {
  auto* const access_control = reinterpret_cast<volatile std::uint32_t*>(0xE000ED88);
  *access_control = *access_control | (0xFu << 20);  // the floating-point unit
  asm volatile("dsb\n isb");
  std::copy(data_in_flash, data_in_flash + (data_end - data_begin), data_begin);
  std::fill(bss_begin, bss_end, 0);
  before_main();
  std::for_each(__init_array_start, __init_array_end, [](void (*construct)()) { construct(); });
  after_main(program());
}

[[noreturn]] void fault() {
  after_main(70);
}
}

__attribute__((section(".vectors"), used)) const void* const vectors[16] = {
    stack_top,
    reinterpret_cast<const void*>(&reset),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
};
