#pragma once
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace sonoloft {

/// Room to work in for the pieces of a parallel_for(), kept for those to come, so that memory is asked for once a
/// thread and not once a piece. Threads: take() from any; no lease outlives the pool.
template <class Scratch>
class ScratchPool {
 public:
  /// One scratch, given back at the end of the lease. What it holds is left from its last use.
  class Lease {
   public:
    Lease(ScratchPool& pool, std::unique_ptr<Scratch> scratch) : pool_(pool), scratch_(std::move(scratch)) {}
    ~Lease() {
      const std::lock_guard lock(pool_.mutex_);
      pool_.free_.push_back(std::move(scratch_));
    }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    [[nodiscard]] Scratch& operator*() const { return *scratch_; }
    [[nodiscard]] Scratch* operator->() const { return scratch_.get(); }

   private:
    ScratchPool& pool_;
    std::unique_ptr<Scratch> scratch_;
  };

  [[nodiscard]] Lease take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return {*this, std::make_unique<Scratch>()};
    std::unique_ptr<Scratch> last = std::move(free_.back());
    free_.pop_back();
    return {*this, std::move(last)};
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> free_;
};

}  // namespace sonoloft
