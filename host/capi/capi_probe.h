#pragma once
#include <memory>

#include "host/capi/sonoloft.h"
#include "host/device/transport.h"

struct sonoloft_probe {
  std::unique_ptr<sonoloft::device::Transport> transport;
};
