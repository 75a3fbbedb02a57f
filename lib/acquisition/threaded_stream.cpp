// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "acquisition/capture_stream.h"
#include "base/error.h"

namespace ada {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestTimeout{60000};
/// A buffer that fails sooner than this after it was made has not timed out.
constexpr milliseconds kTooSoon{50};
constexpr int kFutileAttempts = 3;
/// How long a last answer may take before the connection is cut.
constexpr milliseconds kAnswerTime{250};

/// The thread that reads the buffer and the one that calls next() share a ring of blocks and three
/// atomics: a closed loop must not wait until the other thread, which has no priority, is scheduled
/// again and lets go of a lock.
class ThreadedStream final : public CaptureStream {
public:
  ThreadedStream(const Cancellation &cancellation, BufferFactory factory, std::size_t frames,
                 milliseconds timeout, std::size_t block_bytes, std::size_t blocks,
                 std::string name)
      : cancellation_(cancellation), factory_(std::move(factory)), frames_(frames),
        timeout_(timeout), name_(std::move(name)), slots_(std::max<std::size_t>(blocks, 2)),
        ring_(slots_.size()) {
    for (Slot &slot : slots_)
      slot.bytes.resize(block_bytes);
    free_.reserve(slots_.size());
    for (std::size_t i = slots_.size(); i-- > 0;)
      free_.push_back(i);
    buffer_ = factory_(frames_, timeout_,
                       cancellation_); // in the caller's thread, so that it sees the error
    thread_ = std::thread([this] { run(); });
  }

  ~ThreadedStream() override {
    stop_.store(true);
    ending_.raise(); // a new buffer that is just being made
    room_.ring();
    // libiio complains on stderr of a connection that is cut in the middle of an answer.
    const auto patience = Clock::now() + kAnswerTime;
    while (!ended_.load() && Clock::now() < patience)
      arrived_.wait(patience);
    {
      const std::lock_guard lock(buffer_mutex_);
      if (buffer_)
        buffer_->cancel();
    }
    thread_.join();
  }
  ThreadedStream(const ThreadedStream &) = delete;
  ThreadedStream &operator=(const ThreadedStream &) = delete;

  Event next(CaptureBlock &block, Clock::time_point deadline) override {
    if (lent_) { // the block of the last call is used up
      lent_ = false;
      taken_.fetch_add(1);
      room_.ring();
    }
    for (bool last_look = false;; last_look = Clock::now() >= deadline) {
      if (cancellation_.raised())
        return Event::cancelled;
      const bool ended = ended_.load(); // before the look at the ring: its last blocks count
      if (const std::size_t taken = taken_.load(); filled_.load() != taken) {
        const Slot &slot = slots_[ring_[taken % ring_.size()]];
        block = {std::span(slot.bytes).first(slot.used), &slot.layout};
        lent_ = true;
        return Event::data;
      }
      if (ended && failure_)
        std::rethrow_exception(failure_);
      if (ended && over_)
        return Event::end;
      if (last_look)
        return Event::timeout;
      wait(deadline);
    }
  }

  void announce_to(Readiness &readiness) override { readiness.watch(arrived_.fd()); }

private:
  struct Slot {
    UntouchedBytes bytes;
    std::size_t used = 0;
    FrameLayout layout;
  };

  void wait(Clock::time_point deadline) {
    pollfd fds[2] = {{cancellation_.fd(), POLLIN, 0}, {arrived_.fd(), POLLIN, 0}};
    if (poll(fds, 2, poll_timeout(deadline)) > 0 && fds[1].revents != 0)
      arrived_.clear();
  }

  bool stopping() const { return stop_.load(); }

  void run() noexcept {
    try {
      while (!stopping() && !over_)
        refill_once();
    } catch (...) {
      failure_ = std::current_exception();
    }
    ended_.store(true);
    arrived_.ring();
  }

  void refill_once() {
    const auto began = Clock::now();
    const std::ptrdiff_t n = buffer_->refill();
    if (n > 0) {
      futile_ = 0;
      push(static_cast<std::size_t>(n));
      return;
    }
    if (stopping())
      return;
    if (n == -ENODATA) { // no device answers that: the recording that the server plays is over
      over_ = true;
      return;
    }
    const auto took = Clock::now() - began;
    const int error = n == 0 ? EPIPE : static_cast<int>(-n);
    // The client reports its own time-out as a broken pipe; a server that died is quick about it.
    const bool timed_out = error == ETIMEDOUT || error == EBADF ||
                           ((error == EPIPE || error == EAGAIN) && took >= timeout_ * 9 / 10);
    if (!timed_out)
      throw Error(ADA4571_ERROR_DISCONNECTED, "the server of " + name_ +
                                                  " ended the connection: " + errno_text(error) +
                                                  "; start again when it is back");
    futile_ = took < kTooSoon && frames_ == 1 ? futile_ + 1 : 0;
    if (futile_ >= kFutileAttempts)
      throw Error(ADA4571_ERROR_IO, "reading from " + name_ + " failed: " + errno_text(error));
    make_buffer_anew();
  }

  /// Frames were coming too slowly for this buffer and this time-out, or the server hangs.
  void make_buffer_anew() {
    frames_ = std::max<std::size_t>(1, frames_ / 2);
    timeout_ = std::min(timeout_ * 2, kLongestTimeout);
    const std::lock_guard lock(buffer_mutex_);
    buffer_.reset();
    for (int attempt = 0; !stopping(); ++attempt) {
      try {
        buffer_ = factory_(frames_, timeout_, ending_);
        return;
      } catch (const Error &e) {
        // The server may not yet have noticed that the old buffer is closed.
        if (e.status() != ADA4571_ERROR_BUSY || attempt == 50)
          throw Error(e.status() == ADA4571_ERROR_BUSY ? ADA4571_ERROR_BUSY
                                                       : ADA4571_ERROR_DISCONNECTED,
                      "the server of " + name_ + " does not answer any more: " + e.what());
      }
      std::this_thread::sleep_for(milliseconds(20));
    }
  }

  /// Waits for a free slot: a reader that is late holds up the server, whose kernel then drops
  /// frames, and the timestamps tell.
  void push(std::size_t n) {
    const std::size_t filled = filled_.load();
    while (filled - taken_.load() == ring_.size()) {
      if (stopping())
        return;
      room_.wait(Clock::time_point::max());
    }
    for (const std::size_t taken = taken_.load(); given_back_ != taken; ++given_back_)
      free_.push_back(ring_[given_back_ % ring_.size()]);
    Slot &slot = slots_[free_.back()];
    if (!buffer_->exchange(slot.bytes)) {
      if (slot.bytes.size() < n)
        slot.bytes.resize(n); // only where the server sends more than was asked for
      std::memcpy(slot.bytes.data(), buffer_->data(), n);
    }
    slot.used = n;
    slot.layout = buffer_->layout();
    ring_[filled % ring_.size()] = free_.back();
    free_.pop_back();
    filled_.store(filled + 1);
    arrived_.ring();
  }

  const Cancellation &cancellation_;
  BufferFactory factory_;
  std::size_t frames_;
  milliseconds timeout_;
  std::string name_;
  int futile_ = 0;

  std::mutex buffer_mutex_; ///< guards the pointer between the end and re-creation
  std::unique_ptr<IioBuffer> buffer_;

  std::vector<Slot> slots_;
  std::vector<std::size_t>
      ring_; ///< the slot of block i, and of those a multiple of the size before
  std::vector<std::size_t>
      free_;                   ///< the thread's; last the one given back last, still in the cache
  std::size_t given_back_ = 0; ///< the thread's: how many of the blocks taken are in free_
  std::atomic<std::size_t> filled_{0}; ///< blocks ever written, by the thread
  std::atomic<std::size_t> taken_{0};  ///< blocks ever used up, by the reader
  std::atomic<bool> stop_{false}, ended_{false};
  Cancellation ending_;
  WakeUp arrived_;             ///< rings for a block, and for the end
  WakeUp room_;                ///< rings for a free slot, and to stop
  bool lent_ = false;          ///< the reader's
  std::exception_ptr failure_; ///< written before `ended_`
  bool over_ = false;          ///< written before `ended_`
  std::thread thread_;
};

} // namespace

std::unique_ptr<CaptureStream> make_threaded_stream(const Cancellation &cancellation,
                                                    BufferFactory factory, std::size_t frames,
                                                    milliseconds timeout, std::size_t block_bytes,
                                                    std::size_t blocks, std::string name) {
  return std::make_unique<ThreadedStream>(cancellation, std::move(factory), frames, timeout,
                                          block_bytes, blocks, std::move(name));
}

} // namespace ada
