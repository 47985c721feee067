#pragma once
#include "device_sim/probe/phantoms/solid_phantom.h"

namespace sonoloft::device_sim {

/// The labels of torso_phantom(). What lies between them is outside: tissue that nobody segments.
enum class Torso : Label { liver = 1, vessel = 2, bone = 3, kidney = 4, tumour = 5 };

/// Six ribs, 16 mm apart, and a spine, of which sound passes neither; behind the ribs a liver with a tree of vessels of
/// 1.5 to 4 mm radius through it and a tumour, beside it a kidney that touches it. 138 mm wide, 126 mm deep (along y
/// from the front rib at 0), 160 mm high: a probe that stands over the front looks along y.
[[nodiscard]] SolidPhantom torso_phantom();

}  // namespace sonoloft::device_sim
