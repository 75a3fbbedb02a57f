// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

namespace ada {

namespace {

std::atomic<unsigned> jobs_wanted{0};

/// Blocks on their way through the two steps.
class Conveyor {
public:
  using Step = std::function<void(std::size_t)>;

  Conveyor(std::size_t count, std::size_t window, const Step &make, const Step &take)
      : count_(count), window_(window), make_(make), take_(take), made_(window, 0) {}

  void run(std::size_t threads) {
    std::vector<std::jthread> helpers;
    helpers.reserve(threads); // beside a running thread nothing may throw
    try {
      while (helpers.size() + 1 < threads)
        helpers.emplace_back([this] { help(); });
    } catch (const std::system_error &) {
      // The system gives no more threads: those that there are do the work.
    }
    lead();
    helpers.clear(); // joins
    if (failure_)
      std::rethrow_exception(failure_);
  }

private:
  bool can_make() const { return next_ < count_ && next_ < taken_ + window_ && !failure_; }
  bool can_take() const { return taken_ < count_ && made_[taken_ % window_] != 0; }

  /// Runs one step without the lock; false when it threw.
  bool step(std::unique_lock<std::mutex> &lock, const Step &work, std::size_t block) {
    lock.unlock();
    std::exception_ptr thrown;
    try {
      work(block);
    } catch (...) {
      thrown = std::current_exception();
    }
    lock.lock();
    if (thrown && (!failure_ || block < failed_)) {
      failure_ = thrown;
      failed_ = block;
    }
    return !thrown;
  }

  void make_next(std::unique_lock<std::mutex> &lock) {
    const std::size_t block = next_++;
    if (step(lock, make_, block))
      made_[block % window_] = 1;
    changed_.notify_all();
  }

  void help() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return can_make() || next_ >= count_ || failure_; });
      if (!can_make())
        return;
      make_next(lock);
    }
  }

  /// After a failure those before it are taken all the same, since one of them may fail, too: which
  /// failure comes out does not depend on the threads.
  bool ended() const { return taken_ >= (failure_ ? failed_ : count_); }

  /// Takes what is ready, and makes blocks itself meanwhile.
  void lead() {
    std::unique_lock lock(mutex_);
    while (!ended()) {
      if (can_take()) {
        if (!step(lock, take_, taken_))
          break;
        made_[taken_ % window_] = 0;
        ++taken_;
        changed_.notify_all();
      } else if (can_make()) {
        make_next(lock);
      } else {
        changed_.wait(lock, [this] { return can_take() || can_make() || ended(); });
      }
    }
    changed_.notify_all();
  }

  const std::size_t count_, window_;
  const Step &make_, &take_;
  std::vector<char> made_; ///< by slot
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0, taken_ = 0, failed_ = 0;
  std::exception_ptr failure_;
};

} // namespace

void set_jobs(unsigned jobs) noexcept {
  constexpr unsigned kMost = 1024;
  jobs_wanted = std::min(jobs, kMost);
}

unsigned jobs() noexcept {
  const unsigned wanted = jobs_wanted;
  return wanted > 0 ? wanted : std::max(1u, std::thread::hardware_concurrency());
}

void detail::run_in_order(std::size_t count, std::size_t window,
                          const std::function<void(std::size_t)> &make,
                          const std::function<void(std::size_t)> &take) {
  const std::size_t threads = std::min<std::size_t>(jobs(), count);
  if (threads > 1)
    return Conveyor(count, window, make, take).run(threads);
  for (std::size_t block = 0; block < count; ++block) {
    make(block);
    take(block);
  }
}

} // namespace ada
