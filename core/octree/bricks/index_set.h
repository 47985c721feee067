#pragma once
#include <cstdint>
#include <vector>

namespace sonoloft {

/// A set of small numbers in the order they were added, emptied in the time of its size.
class IndexSet {
 public:
  bool add(std::uint32_t i) {
    if (i >= member_.size()) member_.resize(i + 1, 0);
    if (member_[i] != 0) return false;
    member_[i] = 1;
    items_.push_back(i);
    return true;
  }
  [[nodiscard]] bool contains(std::uint32_t i) const { return i < member_.size() && member_[i] != 0; }
  [[nodiscard]] const std::vector<std::uint32_t>& items() const { return items_; }
  void clear() {
    for (const std::uint32_t i : items_) member_[i] = 0;
    items_.clear();
  }

 private:
  std::vector<std::uint8_t> member_;
  std::vector<std::uint32_t> items_;
};

}  // namespace sonoloft
