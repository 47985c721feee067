// How scans in C begin and end.
#include <cstring>
#include <thread>

#include "tests/unit/capi/capi_scan.h"

using namespace sonoloft::test;

TEST_CASE("capi life: two scans at once give the same mesh and close in any order") {
  sonoloft_scan* const a = open_scan(6);
  sonoloft_scan* const b = open_scan(6);
  Follower of_a, of_b;
  of_a.start(a);
  of_b.start(b);
  REQUIRE(of_a.wait_for(SONOLOFT_END_OF_DATA));
  REQUIRE(of_b.wait_for(SONOLOFT_END_OF_DATA));
  SUBCASE("in the order of their making") {
    sonoloft_scan_close(a);
    sonoloft_scan_close(b);
  }
  SUBCASE("in the other") {
    sonoloft_scan_close(b);
    sonoloft_scan_close(a);
  }
  SUBCASE("from two threads") {
    std::thread other([a] { sonoloft_scan_close(a); });
    sonoloft_scan_close(b);
    other.join();
  }
  const sonoloft_mesh_arrays* mesh_a = sonoloft_mesh_get_arrays(of_a.last());
  const sonoloft_mesh_arrays* mesh_b = sonoloft_mesh_get_arrays(of_b.last());
  REQUIRE(mesh_a->vertices == mesh_b->vertices);
  REQUIRE(mesh_a->triangles == mesh_b->triangles);
  CHECK(std::memcmp(mesh_a->positions_mm, mesh_b->positions_mm, 3 * mesh_a->vertices * sizeof(float)) == 0);
  CHECK(std::memcmp(mesh_a->label_pairs, mesh_b->label_pairs, 2 * mesh_a->triangles * sizeof(std::uint16_t)) == 0);
}

TEST_CASE("capi life: a probe without a scan, a scan that was never started, one that still runs") {
  sonoloft_close_probe(simulated_probe(3));
  sonoloft_scan_close(open_scan(3));
  sonoloft_scan* const scan = open_scan(2000);
  Follower follower;
  follower.start(scan);
  REQUIRE(follower.wait_for_meshes(1));
  sonoloft_scan_close(scan);
  const int at_end = follower.meshes();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  CHECK(follower.meshes() == at_end);
}

TEST_CASE("capi life: 200 starts and stops at any moment close their books") {
  sonoloft_scan* const scan = open_scan(100'000, 200);
  for (int i = 0; i < 200; ++i) {
    Follower follower;
    follower.start(scan);
    std::this_thread::sleep_for(std::chrono::microseconds(37 * i));
    sonoloft_scan_stop(scan);
    const sonoloft_statistics s = statistics_of(scan);
    REQUIRE(s.closed == 1);
    REQUIRE(s.delivered == s.inserted + s.explained + s.merged + s.refused + s.dropped);
    REQUIRE(s.made == s.sent_on + s.host_dropped + s.crc_bad + s.malformed + s.lost + s.device_dropped);
  }
  sonoloft_scan_close(scan);
}
