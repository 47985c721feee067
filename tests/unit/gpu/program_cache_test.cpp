#include "core/gpu/program_cache.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/gpu/opencl_evaluator.h"
#include "tests/support/temporary_folder.h"

using namespace sonoloft;
namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

namespace {

/// Points the cache at a folder while it lives.
class CacheIn {
 public:
  explicit CacheIn(const fs::path& folder) { setenv("XDG_CACHE_HOME", folder.c_str(), 1); }
  ~CacheIn() { unsetenv("XDG_CACHE_HOME"); }
};

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder / "sonoloft")) files.push_back(entry.path());
  return files;
}

}  // namespace

TEST_CASE("program cache: what was written is read under its key only") {
  const test::TemporaryFolder folder;
  const CacheIn cache(folder.path("cache"));
  const Bytes program = {1, 2, 3, 0, 255};
  CHECK(read_cached_program("device A").empty());
  write_cached_program("device A", program);
  CHECK(read_cached_program("device A") == program);
  CHECK(read_cached_program("device B").empty());
  CHECK(files_in(folder.path("cache")).size() == 1);
}

TEST_CASE("program cache: a file that is cut short, damaged or another's reads as nothing") {
  const test::TemporaryFolder folder;
  const CacheIn cache(folder.path("cache"));
  write_cached_program("key", Bytes(1000, 7));
  const fs::path file = files_in(folder.path("cache")).at(0);
  const auto size = static_cast<std::streamoff>(fs::file_size(file));
  for (const std::streamoff at : {std::streamoff{0}, std::streamoff{9}, std::streamoff{20}, size - 1}) {
    write_cached_program("key", Bytes(1000, 7));
    std::fstream(file, std::ios::binary | std::ios::in | std::ios::out).seekp(at).put('x');
    CHECK(read_cached_program("key").empty());
  }
  for (const std::streamoff length : {std::streamoff{0}, std::streamoff{5}, size - 1}) {
    write_cached_program("key", Bytes(1000, 7));
    fs::resize_file(file, static_cast<std::uintmax_t>(length));
    CHECK(read_cached_program("key").empty());
  }
  write_cached_program("key", Bytes(1000, 7));
  CHECK(read_cached_program("key").size() == 1000);
}

TEST_CASE("program cache: a place that cannot be written is no error") {
  const test::TemporaryFolder folder;
  const CacheIn cache(folder.write("a file", "in the way"));
  write_cached_program("key", Bytes{1});
  CHECK(read_cached_program("key").empty());
}

TEST_CASE("program cache: the OpenCL program is kept, used again, and built again when its file is damaged") {
  const test::TemporaryFolder folder;
  const CacheIn cache(folder.path("cache"));
  const auto first = make_opencl_evaluator(1, KernelForm::by_device);
  if (!first && first.error().code == ErrorCode::no_opencl_device) {
    MESSAGE("SKIPPED: " << first.error().message);
    return;
  }
  REQUIRE_MESSAGE(first, first.error().message);
  const std::vector<fs::path> files = files_in(folder.path("cache"));
  REQUIRE(files.size() == 1);
  const auto written = fs::last_write_time(files[0]);
  REQUIRE(make_opencl_evaluator(1, KernelForm::by_device));
  CHECK(fs::last_write_time(files[0]) == written);
  fs::resize_file(files[0], 100);
  REQUIRE(make_opencl_evaluator(1, KernelForm::by_device));
  CHECK(fs::file_size(files[0]) > 100);
}
