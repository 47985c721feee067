// What a callback in C may do.
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/unit/capi/capi_scan.h"

using namespace sonoloft::test;

namespace {

constexpr std::uint32_t kMany = 2000;  // more than any test waits for

}  // namespace

TEST_CASE("capi callbacks: stop() inside on_mesh makes that callback the last") {
  sonoloft_scan* const scan = open_scan(kMany);
  Follower follower([scan](sonoloft_mesh*) { sonoloft_scan_stop(scan); });
  follower.start(scan);
  REQUIRE(follower.wait_for_meshes(1));
  sonoloft_scan_stop(scan);
  CHECK(follower.meshes() == 1);
  CHECK(statistics_of(scan).closed == 1);
  sonoloft_scan_close(scan);
}

TEST_CASE("capi callbacks: stop() inside on_event makes that callback the last") {
  struct Stopper {
    sonoloft_scan* scan;
    std::atomic<int> events;
  } stopper{open_scan(2), 0};
  sonoloft_callbacks callbacks{};
  callbacks.size = sizeof callbacks;
  callbacks.user = &stopper;
  callbacks.on_event = [](void* user, const sonoloft_event*) {
    auto* self = static_cast<Stopper*>(user);
    sonoloft_scan_stop(self->scan);
    ++self->events;
  };
  REQUIRE(sonoloft_scan_start(stopper.scan, &callbacks, nullptr) == SONOLOFT_OK);
  while (stopper.events == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  sonoloft_scan_stop(stopper.scan);
  CHECK(stopper.events == 1);
  CHECK(statistics_of(stopper.scan).closed == 1);
  sonoloft_scan_close(stopper.scan);
}

TEST_CASE("capi callbacks: close() inside on_mesh, and meshes kept beyond it") {
  sonoloft_scan* const scan = open_scan(kMany);
  Follower follower([scan](sonoloft_mesh*) { sonoloft_scan_close(scan); });
  follower.start(scan);
  REQUIRE(follower.wait_for_meshes(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(follower.meshes() == 1);
  CHECK(sonoloft_mesh_get_arrays(follower.last()) != nullptr);
}

TEST_CASE("capi callbacks: start() inside is wrong_state") {
  sonoloft_scan* const scan = open_scan(2);
  sonoloft_status inside = SONOLOFT_OK;
  Follower follower([&](sonoloft_mesh*) {
    const sonoloft_callbacks callbacks{sizeof callbacks, nullptr, nullptr, nullptr, nullptr};
    inside = sonoloft_scan_start(scan, &callbacks, nullptr);
  });
  follower.start(scan);
  REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
  sonoloft_scan_close(scan);
  CHECK(inside == SONOLOFT_WRONG_STATE);
}

TEST_CASE("capi callbacks: one that throws becomes an event, and the scan goes on to its end") {
  sonoloft_scan* const scan = open_scan(4);
  Follower follower([](sonoloft_mesh*) { throw std::runtime_error("of the test"); });
  follower.start(scan);
  REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
  sonoloft_scan_close(scan);
  CHECK(follower.events(SONOLOFT_CALLBACK_THREW) == follower.meshes());
}

TEST_CASE("capi callbacks: one that sleeps 2 s holds neither the link nor stop() elsewhere for longer") {
  sonoloft_scan* const scan = open_scan(kMany, 50);
  std::atomic<bool> sleeping = false, woke = false;
  Follower follower([&](sonoloft_mesh*) {
    if (sleeping.exchange(true)) return;
    std::this_thread::sleep_for(std::chrono::seconds(2));
    woke = true;
  });
  follower.start(scan);
  while (!sleeping) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto before = statistics_of(scan).delivered;
  while (!woke && statistics_of(scan).delivered < before + 20)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(statistics_of(scan).delivered >= before + 20);
  sonoloft_scan_stop(scan);
  CHECK(woke);
  CHECK(statistics_of(scan).closed == 1);
  sonoloft_scan_close(scan);
}

TEST_CASE("capi callbacks: one that keeps every mesh has them all, as they were, after the scan is gone") {
  std::vector<sonoloft_mesh*> kept;
  std::vector<std::size_t> vertices;
  sonoloft_scan* const scan = open_scan(12);
  Follower follower([&](sonoloft_mesh* mesh) {
    kept.push_back(sonoloft_mesh_retain(mesh));
    vertices.push_back(sonoloft_mesh_get_arrays(mesh)->vertices);
  });
  follower.start(scan);
  REQUIRE(follower.wait_for(SONOLOFT_END_OF_DATA));
  sonoloft_scan_close(scan);
  std::uint64_t slices = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    CHECK(sonoloft_mesh_get_arrays(kept[i])->vertices == vertices[i]);
    for (std::size_t s = 0; s < sonoloft_mesh_get_info(kept[i])->slices; ++s)
      CHECK(sonoloft_mesh_slice(kept[i], s)->id == slices++);
    sonoloft_mesh_release(kept[i]);
  }
  CHECK(slices == 12);
  CHECK(kept.size() == static_cast<std::size_t>(follower.meshes()));
}
