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

} // namespace

namespace detail {

/// Blocks on their way through the two steps.
class Conveyor {
public:
  using Step = std::function<void(std::size_t)>;

  Conveyor(std::size_t count, std::size_t window, const Step &make, const Step &take)
      : count_(count), window_(window), make_(make), take_(take), made_(window, 0) {}

  /// What any number of threads do beside the one that leads; back once nothing is left to hand
  /// out.
  void help() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return can_make() || next_ >= count_ || failure_; });
      if (!can_make())
        return;
      make_next(lock);
    }
  }

  /// Takes what is ready, and makes blocks itself meanwhile: it comes to an end without any help.
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

  /// What a step threw, once nobody works on.
  void rethrow() const {
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

  /// After a failure those before it are taken all the same, since one of them may fail, too: which
  /// failure comes out does not depend on the threads.
  bool ended() const { return taken_ >= (failure_ ? failed_ : count_); }

  const std::size_t count_, window_;
  const Step &make_, &take_;
  std::vector<char> made_; ///< by slot
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0, taken_ = 0, failed_ = 0;
  std::exception_ptr failure_;
};

} // namespace detail

/// The helpers of a scope, started by the first conveyor that has work for them. They help
/// whichever conveyor is open: also the one that a helper leads within a block of another, so that
/// there are never more threads than jobs.
class Helpers::Crew {
  using Conveyor = detail::Conveyor;

public:
  explicit Crew(unsigned threads) : threads_(threads) {}

  ~Crew() {
    {
      const std::lock_guard lock(mutex_);
      leaves_ = true;
    }
    changed_.notify_all();
  } // joins

  unsigned threads() const { return threads_; }

  void run(Conveyor &conveyor, std::size_t blocks) {
    open(conveyor, blocks);
    conveyor.lead();
    close(conveyor);
    conveyor.rethrow();
  }

private:
  struct Opened {
    Conveyor *conveyor;
    std::size_t places; ///< for as many more helpers
    std::size_t helping = 0;
  };

  void open(Conveyor &conveyor, std::size_t blocks) {
    std::size_t wake = std::min<std::size_t>(threads_, blocks) - 1; // one block is the leader's
    {
      const std::lock_guard lock(mutex_);
      start(wake);
      opened_.push_back({&conveyor, wake});
      wake = std::min(wake, waiting_);
    }
    while (wake-- > 0)
      changed_.notify_one();
  }

  void close(Conveyor &conveyor) {
    std::unique_lock lock(mutex_);
    found(conveyor)->places = 0;
    left_.wait(lock, [&] { return found(conveyor)->helping == 0; });
    opened_.erase(found(conveyor));
  }

  std::vector<Opened>::iterator found(const Conveyor &conveyor) {
    return std::find_if(opened_.begin(), opened_.end(),
                        [&](const Opened &o) { return o.conveyor == &conveyor; });
  }

  /// As many helpers as a conveyor has work for, and no more than there may be.
  void start(std::size_t wanted) {
    if (refused_)
      return;
    helpers_.reserve(threads_); // beside a running thread nothing may throw
    try {
      while (helpers_.size() < wanted)
        helpers_.emplace_back([this] { work(); });
    } catch (const std::system_error &) {
      refused_ = true; // the system gives no more: those that there are do the work
    }
  }

  void work();

  const unsigned threads_;
  std::mutex mutex_;
  std::condition_variable changed_, left_;
  std::vector<Opened> opened_;
  std::size_t waiting_ = 0;
  bool refused_ = false, leaves_ = false;
  std::vector<std::jthread> helpers_; ///< last: they end before what they use
};

namespace {

/// Of the scope that this thread works in.
thread_local Helpers::Crew *crew = nullptr;

} // namespace

void Helpers::Crew::work() {
  crew = this;
  std::unique_lock lock(mutex_);
  while (true) {
    // The last opened first: it is within a block of one before.
    const auto has_place = [](const Opened &o) { return o.places > 0; };
    const auto next = std::find_if(opened_.rbegin(), opened_.rend(), has_place);
    if (next != opened_.rend()) {
      Conveyor &conveyor = *next->conveyor;
      --next->places;
      ++next->helping;
      lock.unlock();
      conveyor.help();
      lock.lock();
      const auto helped = found(conveyor);
      helped->places = 0; // it has nothing left to hand out
      if (--helped->helping == 0)
        left_.notify_all();
    } else if (leaves_) {
      return;
    } else {
      ++waiting_;
      changed_.wait(lock);
      --waiting_;
    }
  }
}

Helpers::Helpers() {
  if (crew != nullptr)
    return;
  own_ = std::make_unique<Crew>(jobs());
  crew = own_.get();
}

Helpers::~Helpers() {
  if (own_)
    crew = nullptr;
}

void set_jobs(unsigned jobs) noexcept {
  constexpr unsigned kMost = 1024;
  jobs_wanted = std::min(jobs, kMost);
}

unsigned jobs() noexcept {
  if (crew != nullptr)
    return crew->threads(); // the system is asked once a scope, not for each loop
  const unsigned wanted = jobs_wanted;
  return wanted > 0 ? wanted : std::max(1u, std::thread::hardware_concurrency());
}

void detail::run_in_order(std::size_t count, std::size_t window,
                          const std::function<void(std::size_t)> &make,
                          const std::function<void(std::size_t)> &take) {
  if (count > 1 && jobs() > 1) {
    const Helpers helpers;
    detail::Conveyor conveyor(count, window, make, take);
    return crew->run(conveyor, count);
  }
  for (std::size_t block = 0; block < count; ++block) {
    make(block);
    take(block);
  }
}

} // namespace ada
