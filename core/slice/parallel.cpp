#include "core/slice/parallel.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <condition_variable>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

namespace sonoloft {
namespace {

using Body = std::function<void(std::size_t, std::size_t)>;

/// One call of parallel_for().
class Job {
 public:
  Job(std::size_t count, std::size_t grain, const Body& body)
      : count_(count), grain_(grain), pieces_((count + grain - 1) / grain), body_(body) {}

  [[nodiscard]] std::size_t pieces() const { return pieces_; }
  void work() {
    for (std::size_t piece = next_.fetch_add(1); piece < pieces_; piece = next_.fetch_add(1))
      body_(piece * grain_, std::min(count_, (piece + 1) * grain_));
  }

 private:
  std::size_t count_, grain_, pieces_;
  const Body& body_;
  std::atomic<std::size_t> next_{0};
};

/// Threads that help with the calls of all others, and wait in between: to start one takes as long as a small job.
class Helpers {
 public:
  ~Helpers() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    wake_.notify_all();
  }

  /// Works on a job together with up to `wanted` helpers.
  void run(Job& job, std::size_t wanted) {
    std::list<Offer> mine;
    mine.push_back({&job, wanted, 0});
    const auto offer = mine.begin();
    {
      const std::lock_guard lock(mutex_);
      while (threads_.size() < wanted) threads_.emplace_back([this] { serve(); });
      offers_.splice(offers_.end(), mine);
    }
    wanted == 1 ? wake_.notify_one() : wake_.notify_all();
    job.work();
    std::unique_lock lock(mutex_);
    mine.splice(mine.end(), offers_, offer);
    left_.wait(lock, [&] { return offer->inside == 0; });
  }

 private:
  struct Offer {
    Job* job;
    std::size_t seats, inside;
  };

  void serve() {
    std::unique_lock lock(mutex_);
    for (;;) {
      const auto free = [](const Offer& offer) { return offer.seats > 0; };
      auto offer = offers_.end();
      wake_.wait(lock, [&] {
        offer = std::find_if(offers_.begin(), offers_.end(), free);
        return ending_ || offer != offers_.end();
      });
      if (ending_) return;
      --offer->seats;
      ++offer->inside;
      lock.unlock();
      offer->job->work();
      lock.lock();
      if (--offer->inside == 0) left_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_, left_;
  std::list<Offer> offers_;
  bool ending_ = false;
  std::vector<std::jthread> threads_;  ///< last, so that they end before what they use
};

Helpers& helpers() {
  static Helpers all;
  return all;
}

}  // namespace

void parallel_for(std::size_t count, std::size_t grain, int threads, const Body& body) {
  assert(threads >= 1 && grain >= 1);
  Job job(count, grain, body);
  const std::size_t wanted = std::min(static_cast<std::size_t>(threads), job.pieces());
  if (wanted > 1)
    helpers().run(job, wanted - 1);
  else
    job.work();
}

}  // namespace sonoloft
