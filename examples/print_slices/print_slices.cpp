// Slices and their poses, without a reconstruction.
#include <cstdio>
#include <semaphore>

#include "host/device/session.h"
#include "host/simulated/simulated_probe.h"

using namespace sonoloft;

int main() {
  auto probe = open_simulated_probe({.slices = 5, .rate_hz = 20});
  if (!probe) return std::fprintf(stderr, "%s\n", probe.error().message.c_str()), 1;
  const auto session = device::Session::open(std::move(*probe));
  if (!session) return std::fprintf(stderr, "%s\n", session.error().message.c_str()), 1;

  std::counting_semaphore<> end(0);
  device::Callbacks callbacks;
  callbacks.on_slice = [](std::shared_ptr<const device::DeliveredSlice> delivered) {
    const TrackedSlice& slice = delivered->slice;
    const Eigen::Vector3d origin = slice.image_to_reference.translation();
    std::printf("slice %llu: %zu contours, %zu points, origin (%.1f, %.1f, %.1f) mm\n",
                static_cast<unsigned long long>(slice.id), slice.contours.size(), slice.points.size(), origin.x(),
                origin.y(), origin.z());
  };
  callbacks.on_event = [&end](const device::Event& event) {
    std::printf("%s\n", event.message.c_str());
    if (ends_run(event.kind)) end.release();
  };
  if (auto started = (*session)->start({}, callbacks); !started)
    return std::fprintf(stderr, "%s\n", started.error().message.c_str()), 1;
  end.acquire();
  (*session)->stop();
  std::printf("books closed: %s\n", (*session)->ledger().closed ? "yes" : "no");
}
