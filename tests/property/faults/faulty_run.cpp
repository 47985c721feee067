#include "tests/property/faults/faulty_run.h"

#include <thread>

#include "device_sim/port/fault/faulty_port.h"
#include "tests/property/faults/witness.h"

namespace sonoloft::test {
namespace {

using device_sim::FaultKind;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::uint32_t kEarlier = 10;  // slices of the session before

class Bench {
 public:
  Bench(const Bus& bus, FaultKind kind, std::uint32_t seed, std::uint32_t records)
      : bus_(bus),
        kind_(kind),
        records_(records),
        plan_(kind, seed, one_in(kind, seed, records)),
        device_(loopback_options(8), gated_slices(kEarlier + records, kEarlier, open_)),
        port_(device_.port()),
        session_(open_session(bus_, port_)) {}
  ~Bench() { *open_ = true; }

  FaultyRun run() {
    earlier_session();
    port_.set_plan(plan_);
    Witness witness(session_->calibration());
    if (!start(witness)) return count_faults();
    *open_ = true;
    if (!wait_for_the_end(witness)) return complain("the stream did not end");
    const std::uint64_t made = device_.stats().next_seq;
    const bool told = kind_ != FaultKind::reset && !port_.dead();
    timed([&] { session_->stop(); });
    run_.ledger = session_->ledger();
    judge(witness, told ? std::optional(made) : std::nullopt);
    if (kind_ == FaultKind::host_death) next_host();
    return count_faults();
  }

 private:
  static std::uint32_t one_in(FaultKind kind, std::uint32_t seed, std::uint32_t records) {
    switch (kind) {
      case FaultKind::nak_for_ever:
      case FaultKind::disconnect:
      case FaultKind::freeze:
      case FaultKind::reset:
      case FaultKind::host_death:
        return records / 10 * seed + 1;
      case FaultKind::delay:
      case FaultKind::stall:
        return records / 4;
      case FaultKind::lose_request:
      case FaultKind::lose_reply:
      case FaultKind::cut_reply:
        return 2;
      case FaultKind::disconnect_request:
      case FaultKind::disconnect_reply:
        return 8 + seed;  // the first 8 ask for the time
      default:
        return 5 + 10 * seed;
    }
  }

  FaultyRun& complain(const std::string& what) {
    if (run_.complaint.empty()) run_.complaint = what;
    return run_;
  }
  FaultyRun& count_faults() {
    const auto& counts = port_.counts();
    run_.faults = counts.lost + counts.altered + counts.repeated + counts.held + counts.requests;
    return run_;
  }
  void demand(bool fulfilled, const char* what) {
    if (!fulfilled) complain(what);
  }
  template <class Call>
  void timed(const Call& call) {
    const auto begin = steady_clock::now();
    call();
    run_.slowest_call_ms =
        std::max(run_.slowest_call_ms, std::chrono::duration<double, std::milli>(steady_clock::now() - begin).count());
  }

  void earlier_session() {
    Inbox inbox;
    demand(session_->start({device::StreamMode::lossless, 64}, inbox.callbacks()).has_value(), "no earlier session");
    demand(inbox.wait_for_slices(kEarlier), "the earlier session got stuck");
    session_->stop();
  }

  // A start whose request gets lost fails, and may be tried again. One over a cut cable fails for good.
  bool start(Witness& witness) {
    for (int attempt = 0; attempt < 50; ++attempt) {
      Result<void> started;
      timed([&] { started = session_->start({device::StreamMode::lossless, 64}, witness.callbacks()); });
      if (started) return true;
      if (started.error().code == ErrorCode::transport_closed) {
        demand(port_.dead(), "a start failed over a sound cable");
        demand(witness.delivered == 0, "slices of a run that never began");
        return false;
      }
    }
    complain("no start succeeded");
    return false;
  }

  // What the bus still carries is waited for.
  bool wait_for_the_end(const Witness& witness) {
    const auto limit = steady_clock::now() + std::chrono::seconds(60);
    while (steady_clock::now() < limit) {
      const auto stats = device_.stats();
      const bool stopped = stats.state == static_cast<std::uint16_t>(protocol::DeviceState::idle);
      const bool dead = port_.dead() || stopped;  // first: what it did is counted by then
      const device::Ledger l = session_->ledger();
      const bool altered_came = l.crc_bad + l.malformed >= port_.counts().altered;
      const bool all_came =
          stats.next_seq == records_ && l.delivered + l.crc_bad + l.malformed + port_.counts().lost >= records_;
      if (all_came || (dead && altered_came) || witness.disconnected != 0) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }

  void judge(const Witness& witness, std::optional<std::uint64_t> made) {
    const device::Ledger& l = run_.ledger;
    const auto& counts = port_.counts();
    demand(l.closed, "the books did not close");
    demand(l.made == l.delivered + l.host_dropped + l.crc_bad + l.malformed + l.transport_lost + l.device_dropped,
           "the equation does not hold");
    demand(l.delivered == witness.delivered, "the books say another number of slices than came");
    demand(witness.wrong == 0, "a slice came that was not sent, or altered, or out of order");
    demand(witness.disconnected <= 1 && witness.after_the_end == 0, "disconnected was not the last");
    demand(l.crc_bad + l.malformed == counts.altered, "altered records are not those that were altered");
    demand(l.foreign <= counts.repeated && l.foreign + 1 >= counts.repeated, "foreign records are not those repeated");
    if (!made) return;  // nobody could ask the device in the end
    const bool requests_work = kind_ < FaultKind::lose_request;
    if (requests_work) demand(l.made == *made, "the books and the device disagree");
    if (requests_work) demand(l.transport_lost == counts.lost, "lost records are not those that were lost");
    // Where half of the requests get lost, a device may hear nothing for too long.
    const bool gave_up = device_.stats().fault == static_cast<std::uint16_t>(protocol::DeviceFault::watchdog);
    demand(l.device_dropped == 0 || gave_up, "a lossless device dropped");
  }

  // Whoever comes after a host that died finds a device that streams for somebody else.
  void next_host() {
    Inbox inbox;
    auto session = open_session(bus_, device_.port());
    demand(session->start({device::StreamMode::lossless, 64}, inbox.callbacks()).has_value(),
           "the next host cannot start");
    demand(inbox.wait_for(device::EventKind::end_of_data), "the next host gets nothing");
    session->stop();
    const auto ledger = session->ledger();
    demand(ledger.closed && ledger.foreign == 0 && ledger.delivered == ledger.made && ledger.made > 0,
           "the next host pays for the last one");
  }

  const Bus& bus_;
  FaultKind kind_;
  std::uint32_t records_;
  FaultyRun run_;
  std::shared_ptr<std::atomic<bool>> open_ = std::make_shared<std::atomic<bool>>(false);
  device_sim::FaultPlan plan_;
  device_sim::LoopbackDevice device_;
  device_sim::FaultyPort port_;
  std::unique_ptr<device::Session> session_;
};

}  // namespace

FaultyRun faulty_run(const Bus& bus, FaultKind kind, std::uint32_t seed, std::uint32_t records) {
  return Bench(bus, kind, seed, records).run();
}

}  // namespace sonoloft::test
