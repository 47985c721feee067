#include "device_sim/port/fault/fault_plan.h"

#include <algorithm>

namespace sonoloft::device_sim {
namespace {

// After one of these nothing is left to suffer.
bool is_final(FaultKind kind) {
  switch (kind) {
    case FaultKind::nak_for_ever:
    case FaultKind::disconnect:
    case FaultKind::freeze:
    case FaultKind::reset:
    case FaultKind::host_death:
    case FaultKind::disconnect_request:
    case FaultKind::disconnect_reply:
      return true;
    default:
      return false;
  }
}

bool is_of_requests(FaultKind kind) {
  return kind >= FaultKind::lose_request;
}

}  // namespace

const char* name(FaultKind kind) {
  static constexpr std::array<const char*, kFaultKindCount> kNames{
      "none",  "drop",       "duplicate",    "swap",         "stale",     "truncate",           "extend",
      "flip",  "delay",      "stall",        "nak_for_ever", "halt",      "disconnect",         "freeze",
      "reset", "host_death", "lose_request", "lose_reply",   "cut_reply", "disconnect_request", "disconnect_reply"};
  const auto i = static_cast<std::size_t>(kind);
  return i < kFaultKindCount ? kNames[i] : "none";
}

FaultPlan FaultPlan::once(FaultKind kind, std::uint64_t index, std::size_t offset) {
  FaultPlan plan(kind, 1, 1);
  plan.only_ = index;
  plan.offset_ = offset;
  return plan;
}

bool FaultPlan::strikes_record() {
  return !is_of_requests(kind_) && strikes(records_);
}

bool FaultPlan::strikes_request() {
  return is_of_requests(kind_) && strikes(requests_);
}

bool FaultPlan::strikes(std::uint64_t& count) {
  const std::uint64_t index = count++;
  if (kind_ == FaultKind::none) return false;
  if (only_) return index == *only_;
  if (is_final(kind_)) return index + 1 == one_in_;
  return random_() % one_in_ == 0;
}

std::size_t FaultPlan::offset(std::size_t size) {
  if (size == 0) return 0;
  return only_ ? std::min(offset_, size - 1) : random_() % size;
}

}  // namespace sonoloft::device_sim
