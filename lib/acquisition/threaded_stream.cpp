// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cerrno>
#include <condition_variable>
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

class ThreadedStream final : public CaptureStream {
public:
  ThreadedStream(BufferFactory factory, std::size_t frames, milliseconds timeout,
                 std::size_t block_bytes, std::size_t blocks, std::string name)
      : factory_(std::move(factory)), frames_(frames), timeout_(timeout), name_(std::move(name)),
        slots_(std::max<std::size_t>(blocks, 2)) {
    for (Slot &slot : slots_)
      slot.bytes.resize(block_bytes);
    buffer_ = factory_(frames_, timeout_); // in the caller's thread, so that it sees the error
    thread_ = std::thread([this] { run(); });
  }

  ~ThreadedStream() override {
    {
      std::unique_lock lock(mutex_);
      stop_ = true;
      changed_.notify_all();
      // libiio complains on stderr of a connection that is cut in the middle of an answer.
      changed_.wait_for(lock, kAnswerTime, [this] { return ended_; });
    }
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
    std::unique_lock lock(mutex_);
    if (lent_) { // the block of the last call is used up
      lent_ = false;
      first_ = (first_ + 1) % slots_.size();
      --filled_;
      changed_.notify_all();
    }
    const auto something = [this] { return cancelled_ || filled_ > 0 || failure_; };
    if (deadline == Clock::time_point::max())
      changed_.wait(lock, something);
    else
      changed_.wait_until(lock, deadline, something);
    if (cancelled_)
      return Event::cancelled;
    if (filled_ > 0) {
      const Slot &slot = slots_[first_];
      block = {std::span(slot.bytes).first(slot.used), &slot.layout};
      lent_ = true;
      return Event::data;
    }
    if (failure_)
      std::rethrow_exception(failure_);
    return Event::timeout;
  }

  void cancel() noexcept override {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    changed_.notify_all();
  }

private:
  struct Slot {
    std::vector<std::byte> bytes;
    std::size_t used = 0;
    FrameLayout layout;
  };

  bool stopping() {
    const std::lock_guard lock(mutex_);
    return stop_;
  }

  void run() noexcept {
    std::exception_ptr failure;
    try {
      while (!stopping())
        refill_once();
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    failure_ = failure;
    ended_ = true;
    changed_.notify_all();
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
        buffer_ = factory_(frames_, timeout_);
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
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stop_ || filled_ < slots_.size(); });
    if (stop_)
      return;
    Slot &slot = slots_[(first_ + filled_) % slots_.size()];
    lock.unlock(); // the slot is not yet visible to the reader
    if (slot.bytes.size() < n)
      slot.bytes.resize(n); // only where the server sends more than was asked for
    std::memcpy(slot.bytes.data(), buffer_->data(), n);
    slot.used = n;
    slot.layout = buffer_->layout();
    lock.lock();
    ++filled_;
    changed_.notify_all();
  }

  BufferFactory factory_;
  std::size_t frames_;
  milliseconds timeout_;
  std::string name_;
  int futile_ = 0;

  std::mutex buffer_mutex_; ///< guards the pointer between cancel and re-creation
  std::unique_ptr<IioBuffer> buffer_;

  std::mutex mutex_; ///< guards everything below
  std::condition_variable changed_;
  std::vector<Slot> slots_;
  std::size_t first_ = 0, filled_ = 0;
  bool lent_ = false, stop_ = false, ended_ = false, cancelled_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

} // namespace

std::unique_ptr<CaptureStream> make_threaded_stream(BufferFactory factory, std::size_t frames,
                                                    milliseconds timeout, std::size_t block_bytes,
                                                    std::size_t blocks, std::string name) {
  return std::make_unique<ThreadedStream>(std::move(factory), frames, timeout, block_bytes, blocks,
                                          std::move(name));
}

} // namespace ada
