#include "device_sim/port/functionfs/function_words.h"

#include <linux/usb/functionfs.h>

#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <span>

namespace sonoloft::device_sim::functionfs {
namespace {

void append(std::vector<std::byte>& out, std::initializer_list<std::size_t> numbers) {
  for (const std::size_t number : numbers) {
    for (const int shift : {0, 8, 16, 24}) out.push_back(static_cast<std::byte>(number >> shift & 0xFF));
  }
}

std::span<const std::byte> without_header(std::span<const std::byte> configuration) {
  constexpr std::size_t kHeader = 9;
  return configuration.subspan(kHeader);
}

std::string hex(std::span<const std::byte> little_endian) {
  char text[8];
  std::snprintf(text, sizeof text, "0x%02x%02x", std::to_integer<unsigned>(little_endian[1]),
                std::to_integer<unsigned>(little_endian[0]));
  return text;
}

std::string ascii(std::span<const std::byte> string_descriptor) {
  std::string text;
  for (std::size_t i = 2; i < string_descriptor.size(); i += 2) text += std::to_integer<char>(string_descriptor[i]);
  return text;
}

}  // namespace

std::vector<std::byte> function_descriptors(const usb::Descriptors& descriptors) {
  constexpr std::size_t kHeader = sizeof(usb_functionfs_descs_head_v2) + 2 * 4, kEach = 1 + 3;
  const auto full = without_header(*descriptors.find(0x0700)), high = without_header(*descriptors.find(0x0200));
  std::vector<std::byte> out;
  append(out, {FUNCTIONFS_DESCRIPTORS_MAGIC_V2, kHeader + full.size() + high.size(),
               FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC, kEach, kEach});
  out.insert(out.end(), full.begin(), full.end());
  out.insert(out.end(), high.begin(), high.end());
  return out;
}

std::vector<std::byte> function_strings() {
  std::vector<std::byte> out;
  append(out, {FUNCTIONFS_STRINGS_MAGIC, sizeof(usb_functionfs_strings_head), 0, 0});
  return out;
}

std::vector<Attribute> gadget_attributes(const usb::Descriptors& descriptors) {
  const auto device = *descriptors.find(0x0100);
  const auto string = [&](std::uint8_t index) {
    return ascii(*descriptors.find(static_cast<std::uint16_t>(0x0300 | index)));
  };
  const auto index_at = [&](std::size_t at) { return std::to_integer<std::uint8_t>(device[at]); };
  return {{"idVendor", hex(device.subspan(8))},
          {"idProduct", hex(device.subspan(10))},
          {"bcdDevice", hex(device.subspan(12))},
          {"strings/0x409/manufacturer", string(index_at(14))},
          {"strings/0x409/product", string(index_at(15))},
          {"strings/0x409/serialnumber", string(index_at(16))}};
}

}  // namespace sonoloft::device_sim::functionfs
