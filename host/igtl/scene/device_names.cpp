#include "host/igtl/scene/device_names.h"

#include "host/igtl/wire/message.h"

namespace sonoloft::igtl {
namespace {

std::string cut(std::string text, std::size_t size) {
  constexpr int kContinued = 0x80, kMask = 0xC0;  // the first two bits of a byte within a character
  if (text.size() <= size) return text;
  while (size > 0 && (text[size] & kMask) == kContinued) --size;
  text.resize(size);
  return text;
}

}  // namespace

const std::string& DeviceNames::of(Label label) {
  if (const auto known = names_.find(label); known != names_.end()) return known->second;
  const std::string full = labels_.name(label), number = ' ' + std::to_string(label);
  std::string name = full;
  for (std::size_t room = kNameLen - number.size(); name.size() > kNameLen || given_.contains(name); --room)
    name = cut(full, room) + number;
  given_.emplace(name, label);
  return names_.emplace(label, std::move(name)).first->second;
}

}  // namespace sonoloft::igtl
