#include "host/device/ledger.h"

namespace sonoloft::device {

bool Books::receive(std::uint64_t seq, std::uint32_t device_dropped_total) {
  if (seq < next_seq_) {
    ++ledger_.foreign;
    return false;
  }
  ++received_;
  next_seq_ = seq + 1;
  bad_since_ = 0;
  ledger_.device_dropped = device_dropped_total;
  return true;
}

void Books::receive_crc_bad() {
  ++ledger_.crc_bad;
  ++bad_since_;
}

void Books::receive_malformed() {
  ++ledger_.malformed;
  ++bad_since_;
}

std::uint64_t Books::accounted() const {
  return received_ + ledger_.crc_bad + ledger_.malformed + ledger_.device_dropped;
}

Ledger Books::ledger() const {
  Ledger result = ledger_;
  if (ended_) return result;
  result.made = seen();
  result.transport_lost = result.made > accounted() ? result.made - accounted() : 0;
  return result;
}

void Books::close(const std::optional<protocol::StatsReply>& stats) {
  ended_ = true;
  ledger_.made = seen();
  if (stats) {
    ledger_.made = stats->next_seq;
    ledger_.device_dropped = stats->dropped;
  }
  const bool plausible = !stats || (stats->next_seq >= next_seq_ && stats->sent + stats->dropped == stats->next_seq);
  ledger_.transport_lost = ledger_.made > accounted() ? ledger_.made - accounted() : 0;
  ledger_.closed = plausible && ledger_.made == accounted() + ledger_.transport_lost &&
                   received_ == ledger_.delivered + ledger_.host_dropped;
}

}  // namespace sonoloft::device
