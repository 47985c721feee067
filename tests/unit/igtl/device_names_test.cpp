#include "host/igtl/scene/device_names.h"

#include <doctest/doctest.h>

#include <set>

using namespace sonoloft;
using igtl::DeviceNames;

TEST_CASE("device names: what the table calls a label, else its number") {
  LabelTable table;
  REQUIRE(table.add(3, "portal vein", {200, 0, 0}));
  DeviceNames names(table);
  CHECK(names.of(3) == "portal vein");
  CHECK(names.of(7) == "label 7");
  CHECK(names.of(kMaxLabel) == "label 65520");
}

TEST_CASE("device names: none is longer than 20 bytes or the same as another") {
  LabelTable table;
  REQUIRE(table.add(1, "inferior vena cava, hepatic part", {0, 0, 1}));
  REQUIRE(table.add(2, "inferior vena cava, thoracic part", {0, 0, 2}));
  REQUIRE(table.add(3, "twenty bytes exactly", {0, 0, 3}));
  REQUIRE(table.add(4, "label 5", {0, 0, 4}));
  REQUIRE(table.add(6, "liver", {0, 0, 5}));
  REQUIRE(table.add(7, "liver", {0, 0, 6}));
  DeviceNames names(table);
  CHECK(names.of(1) == "inferior vena cava 1");
  CHECK(names.of(2) == "inferior vena cava 2");
  CHECK(names.of(3) == "twenty bytes exactly");
  CHECK(names.of(4) == "label 5");
  CHECK(names.of(5) == "label 5 5");
  CHECK(names.of(7) == "liver");
  CHECK(names.of(6) == "liver 6");
  CHECK(names.of(1) == "inferior vena cava 1");
}

TEST_CASE("device names: a name is cut between characters, not within one") {
  LabelTable table;
  REQUIRE(table.add(1234, "Schilddrüsenläppchen", {0, 0, 0}));                       // 22 bytes
  REQUIRE(table.add(345, "\u80dd\u81df\u80dd\u81df\u80dd\u81df\u80dd", {0, 0, 0}));  // 21, three each
  DeviceNames names(table);
  CHECK(names.of(1234) == "Schilddrüsenl 1234");
  CHECK(names.of(345) == "\u80dd\u81df\u80dd\u81df\u80dd 345");
}
