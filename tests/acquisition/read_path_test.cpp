// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a control loop needs of the read path: in the reading thread no memory is allocated and no
// lock is taken, so that it can wait for no thread that holds one. This program puts functions of
// its own before those of the C library and counts their calls.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <numeric>

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include "acquisition/capture_stream.h"
#include "acquisition/iio_source.h"
#include "ada4571.h"
#include "served.h"
#include "support/temp_folder.h"

namespace {

struct Calls {
  unsigned allocations = 0, locks = 0;
};
thread_local Calls *counting = nullptr;

/// Counts in this thread while it lives.
class Counted {
public:
  explicit Counted(Calls &calls) { counting = &calls; }
  ~Counted() { counting = nullptr; }
  Counted(const Counted &) = delete;
  Counted &operator=(const Counted &) = delete;
};

void count_allocation() {
  if (counting)
    ++counting->allocations;
}

/// The function that this program's own one of the same name hides.
template <class Function> Function *next(const char *name) {
  return reinterpret_cast<Function *>(dlsym(RTLD_NEXT, name));
}

template <class Function, class... Arguments>
int counted_lock(Function *&real, const char *name, Arguments... arguments) {
  if (counting)
    ++counting->locks;
  if (!real)
    real = next<Function>(name);
  return real(arguments...);
}

} // namespace

// NOLINTBEGIN: names of the C library
extern "C" {
void *__libc_malloc(std::size_t);
void *__libc_calloc(std::size_t, std::size_t);
void *__libc_realloc(void *, std::size_t);

void *malloc(std::size_t size) {
  count_allocation();
  return __libc_malloc(size);
}
void *calloc(std::size_t count, std::size_t size) {
  count_allocation();
  return __libc_calloc(count, size);
}
void *realloc(void *old, std::size_t size) {
  count_allocation();
  return __libc_realloc(old, size);
}

int pthread_mutex_lock(pthread_mutex_t *mutex) {
  static int (*real)(pthread_mutex_t *) = nullptr;
  return counted_lock(real, "pthread_mutex_lock", mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t *lock) {
  static int (*real)(pthread_rwlock_t *) = nullptr;
  return counted_lock(real, "pthread_rwlock_rdlock", lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t *lock) {
  static int (*real)(pthread_rwlock_t *) = nullptr;
  return counted_lock(real, "pthread_rwlock_wrlock", lock);
}
int pthread_cond_clockwait(pthread_cond_t *condition, pthread_mutex_t *mutex, clockid_t clock,
                           const struct timespec *until) {
  static int (*real)(pthread_cond_t *, pthread_mutex_t *, clockid_t, const struct timespec *) =
      nullptr;
  return counted_lock(real, "pthread_cond_clockwait", condition, mutex, clock, until);
}
}
// NOLINTEND

using namespace ada;
using namespace ada::test;

namespace {

const ScanFormat kU16{16, 16, 0, 1, false, false};

TEST(ReadPath, calls_are_counted) {
  std::mutex mutex;
  Calls calls;
  {
    const Counted counted(calls);
    const std::lock_guard lock(mutex);
    const std::vector<int> allocated(1000);
    EXPECT_EQ(allocated.back(), 0);
  }
  EXPECT_EQ(calls.allocations, 1u);
  EXPECT_EQ(calls.locks, 1u);
}

TEST(ReadPath, reading_a_network_device_and_converting_neither_allocates_nor_locks) {
  const Served served(served_pair(kU16, kU16, 10000.0));
  ada4571_source_options options;
  ada4571_source_options_init(&options);
  const std::string uri = served.uri();
  options.uri = uri.c_str();
  options.buffer_frames = 20;
  ada4571_source *source = nullptr;
  ASSERT_EQ(ada4571_source_open(&options, &source), ADA4571_OK) << ada4571_last_error();
  ada4571_baseline baseline;
  ada4571_baseline_init(&baseline);
  ada4571_model *model = nullptr;
  ASSERT_EQ(ada4571_model_new(&baseline, &model), ADA4571_OK);
  ada4571_converter *converter = nullptr;
  ASSERT_EQ(ada4571_converter_new(model, &converter), ADA4571_OK);
  ASSERT_EQ(ada4571_source_start(source), ADA4571_OK) << ada4571_last_error();

  std::array<ada4571_frame, 64> frames;
  std::array<ada4571_angle, 64> angles;
  std::size_t n = 0, read = 0;
  ada4571_read_outcome outcome = ADA4571_READ_FRAMES;
  Calls calls;
  const auto read_until = [&](std::size_t wanted) {
    while (read < wanted) {
      ASSERT_EQ(ada4571_source_read(source, frames.data(), frames.size(), 1000, &n, &outcome),
                ADA4571_OK);
      ASSERT_NE(outcome, ADA4571_READ_END);
      ASSERT_EQ(ada4571_converter_frames(converter, frames.data(), n, angles.data()), ADA4571_OK);
      read += n;
    }
  };
  read_until(200); // the period is learned from the first frames
  {
    const Counted counted(calls);
    read_until(3000);
  }
  EXPECT_EQ(calls.allocations, 0u);
  EXPECT_EQ(calls.locks, 0u);
  ada4571_source_statistics statistics;
  ada4571_source_statistics_init(&statistics);
  EXPECT_EQ(ada4571_source_get_statistics(source, &statistics), ADA4571_OK);
  EXPECT_EQ(statistics.lost, 0u);
  ada4571_converter_free(converter);
  ada4571_model_free(model);
  ada4571_source_free(source);
}

TEST(ReadPath, recording_blocks_of_a_network_device_does_not_allocate) {
  const Served served(served_pair(kU16, kU16, 10000.0));
  const TempFolder folder;
  ada4571_source_options options;
  ada4571_source_options_init(&options);
  const std::string uri = served.uri(), path = folder / "c.sigmf-meta";
  options.uri = uri.c_str();
  options.buffer_frames = 100;
  ada4571_source *source = nullptr;
  ASSERT_EQ(ada4571_source_open(&options, &source), ADA4571_OK) << ada4571_last_error();
  ada4571_recording_info info;
  ada4571_recording_info_init(&info);
  info.sample_rate_hz = 10000.0;
  ada4571_writer *writer = nullptr;
  ASSERT_EQ(ada4571_writer_open_blocks(path.c_str(), &info, source, 0, &writer), ADA4571_OK)
      << ada4571_last_error();
  ASSERT_EQ(ada4571_source_start(source), ADA4571_OK) << ada4571_last_error();
  ada4571_block block;
  ada4571_block_init(&block);
  ada4571_read_outcome outcome = ADA4571_READ_FRAMES;
  std::size_t read = 0;
  const auto record_until = [&](std::size_t wanted) {
    while (read < wanted) {
      ASSERT_EQ(ada4571_source_read_block(source, SIZE_MAX, 1000, &block, &outcome), ADA4571_OK);
      ASSERT_NE(outcome, ADA4571_READ_END);
      ASSERT_EQ(ada4571_writer_write_block(writer, source, block.count, 0.0), ADA4571_OK)
          << ada4571_last_error();
      read += block.count;
    }
  };
  record_until(300);
  Calls calls;
  {
    const Counted counted(calls);
    record_until(5000);
  }
  EXPECT_EQ(calls.allocations, 0u);
  EXPECT_EQ(ada4571_writer_finish(writer), ADA4571_OK) << ada4571_last_error();
  ada4571_writer_free(writer);
  ada4571_source_free(source);
  ada4571_recording *recording = nullptr;
  ASSERT_EQ(ada4571_recording_open(path.c_str(), &recording), ADA4571_OK) << ada4571_last_error();
  EXPECT_EQ(ada4571_recording_get_info(recording, &info), ADA4571_OK);
  EXPECT_EQ(info.samples, read);
  ada4571_recording_free(recording);
}

/// A buffer with an fd to poll, as that of a local device, fed through a pipe.
class PipeBuffer final : public IioBuffer {
public:
  explicit PipeBuffer(int fd) : fd_(fd), layout_(compute_layout(std::array{kU16, kU16})) {}
  std::ptrdiff_t refill() override {
    const ssize_t n = ::read(fd_, bytes_.data(), bytes_.size());
    return n < 0 ? -errno : n;
  }
  const std::byte *data() const override { return bytes_.data(); }
  int poll_fd() const override { return fd_; }
  const FrameLayout &layout() override { return layout_; }
  void cancel() noexcept override {}

private:
  int fd_;
  FrameLayout layout_;
  std::array<std::byte, 64> bytes_{};
};

TEST(ReadPath, a_local_buffer_is_polled_without_allocating_or_locking) {
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_NONBLOCK), 0);
  const Cancellation cancellation;
  const auto stream =
      make_polled_stream(cancellation, std::make_unique<PipeBuffer>(ends[0]), "/", "pipe");
  std::thread feeder([&] {
    for (int i = 0; i < 50; ++i) {
      std::array<std::uint16_t, 32> words;
      std::iota(words.begin(), words.end(), static_cast<std::uint16_t>(i));
      ASSERT_EQ(write(ends[1], words.data(), sizeof words), static_cast<ssize_t>(sizeof words));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  Calls calls;
  std::size_t bytes = 0;
  {
    const Counted counted(calls);
    CaptureBlock block;
    while (bytes < 50 * 64) {
      const auto event =
          stream->next(block, CaptureStream::Clock::now() + std::chrono::seconds(10));
      if (event != CaptureStream::Event::data)
        break;
      bytes += block.bytes.size();
    }
  }
  feeder.join();
  EXPECT_EQ(bytes, 50u * 64u);
  EXPECT_EQ(calls.allocations, 0u);
  EXPECT_EQ(calls.locks, 0u);
  close(ends[0]);
  close(ends[1]);
}

TEST(ReadPath, latency_chooses_the_length_of_the_buffers) {
  const Served served(served_pair(kU16, kU16, 2000.0));
  const auto frames = [&](double latency_s, std::size_t asked) {
    IioSourceOptions options;
    options.uri = served.uri();
    options.latency_s = latency_s;
    options.buffer_frames = asked;
    return open_iio_source(options)->info().buffer_frames;
  };
  EXPECT_EQ(frames(0.0, 0), 100u);
  EXPECT_EQ(frames(0.01, 0), 20u);
  EXPECT_EQ(frames(1e-5, 0), 1u);
  EXPECT_EQ(frames(0.01, 7), 7u);
  EXPECT_THROW(frames(-1.0, 0), Error);
}

TEST(ReadPath, the_age_of_a_frame_is_told_by_clock_and_first_timestamp) {
  const Served served(served_pair(kU16, kU16, 1000.0));
  IioSourceOptions options;
  options.uri = served.uri();
  const auto source = open_iio_source(options);
  std::array<Frame, 100> frames;
  const auto oldest_s = [&](std::size_t buffer) {
    source->set_buffer_frames(buffer);
    source->start();
    double age = INFINITY;
    for (int i = 0; i < 3; ++i) {
      const ReadResult r = source->read(frames, std::chrono::seconds(10));
      timespec now{};
      clock_gettime(source->info().timestamp_clock, &now);
      const std::int64_t now_ns = now.tv_sec * std::int64_t{1000000000} + now.tv_nsec;
      if (r.count > 0)
        age = std::min(
            age, 1e-9 * static_cast<double>(now_ns - source->statistics().first_timestamp_ns) -
                     frames.front().time_s);
    }
    source->stop();
    return age;
  };
  // The first frame of a buffer has waited for all the others.
  EXPECT_GE(oldest_s(100), 0.099);
  EXPECT_LT(oldest_s(1), oldest_s(100));
  EXPECT_GE(oldest_s(1), 0.0);
}

} // namespace
