#include "core/gpu/program_cache.h"

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace sonoloft {
namespace {

namespace fs = std::filesystem;

std::uint64_t fnv1a(std::span<const unsigned char> bytes) {
  std::uint64_t hash = 0xCBF29CE484222325ull;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001B3ull;
  return hash;
}

std::uint64_t fnv1a(const std::string& text) {
  return fnv1a({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

/// Empty when the environment names no place.
fs::path file_of(const std::string& key) {
  fs::path folder;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/')
    folder = cache;
  else if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    folder = fs::path(home) / ".cache";
  else
    return {};
  char name[32];
  std::snprintf(name, sizeof name, "%016llx.clbin", static_cast<unsigned long long>(fnv1a(key)));
  return folder / "sonoloft" / name;
}

/// In front of the program: what it was built from, and that it is whole.
struct Header {
  std::uint64_t key_hash, key_size, program_hash, program_size;
  friend bool operator==(const Header&, const Header&) = default;
};

Header header_of(const std::string& key, std::span<const unsigned char> program) {
  return {fnv1a(key), key.size(), fnv1a(program), program.size()};
}

}  // namespace

std::vector<unsigned char> read_cached_program(const std::string& key) {
  const fs::path path = file_of(key);
  if (path.empty()) return {};
  std::ifstream file(path, std::ios::binary);
  std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  Header header;
  if (bytes.size() < sizeof header) return {};
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes.erase(bytes.begin(), bytes.begin() + sizeof header);
  if (header != header_of(key, bytes)) return {};
  return bytes;
}

void write_cached_program(const std::string& key, std::span<const unsigned char> program) {
  const fs::path path = file_of(key);
  if (path.empty()) return;
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  // Written aside and renamed: another process sees the whole file or none.
  const fs::path aside = path.string() + "." + std::to_string(::getpid());
  const Header header = header_of(key, program);
  std::ofstream file(aside, std::ios::binary);
  file.write(reinterpret_cast<const char*>(&header), sizeof header);
  file.write(reinterpret_cast<const char*>(program.data()), static_cast<std::streamsize>(program.size()));
  file.close();
  if (file)
    fs::rename(aside, path, ignored);
  else
    fs::remove(aside, ignored);
}

}  // namespace sonoloft
