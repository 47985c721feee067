#include "core/methods/catalogue.h"

#include <doctest/doctest.h>

#include "tests/support/stacks/stack_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

TEST_CASE("methods: each is found by its name, takes its standard options and makes surfaces of a stack") {
  const std::vector<TrackedSlice> slices{slice_at(0, {circle({0, 0}, 10)}), slice_at(4, {circle({0, 0}, 9)}),
                                         slice_at(8, {circle({0, 0}, 8)})};
  CHECK(methods().size() >= 2);
  for (const Method& method : methods()) {
    REQUIRE(find_method(method.name) == &method);
    const auto settings = settings_of(method, {});
    REQUIRE(settings);
    const auto surfaces = method.run({slices, 0.5, 1, *settings});
    REQUIRE(surfaces);
    CHECK(surfaces->mesh.triangles.size() > 1000);
    CHECK(surfaces->notes.empty());
  }
  CHECK(find_method("no such method") == nullptr);
}

TEST_CASE("methods: an option that is not there and a value that it cannot have are errors that list what can be") {
  const Method& method = *find_method("metamorphosis");
  const auto error = [&](const std::string& text) { return settings_of(method, std::vector{text}).error(); };
  CHECK(settings_of(method, std::vector<std::string>{"ends=flat"})->at("ends") == "flat");
  CHECK(error("end=flat").code == ErrorCode::invalid_argument);
  CHECK(error("end=flat").message.find("ends") != std::string::npos);
  CHECK(error("ends=open").message.find("flat, round") != std::string::npos);
  CHECK(error("ends").code == ErrorCode::invalid_argument);
  CHECK(error("").code == ErrorCode::invalid_argument);
}

TEST_CASE("methods: more cells than can be held are an error before they are asked for") {
  const std::vector<TrackedSlice> slices{slice_at(0, {circle({0, 0}, 10)}), slice_at(4, {circle({0, 0}, 9)})};
  for (const char* name : {"equal-importance", "metamorphosis"}) {
    const Method& method = *find_method(name);
    const auto refused = method.run({slices, 1e-5, 1, *settings_of(method, {})});
    REQUIRE(!refused);
    CHECK(refused.error().code == ErrorCode::too_large);
  }
}
