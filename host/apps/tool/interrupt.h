#pragma once

namespace sonoloft::tool {

/// From now on Ctrl-C (SIGINT) and SIGTERM are noted instead of ending the process; a second one ends it.
void note_interrupts();
[[nodiscard]] bool interrupted();

}  // namespace sonoloft::tool
