// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A megasample a second of sin, cos, VTEMP and timestamp from a local device: no frame lost, no
// allocation in steady state, and processor time to spare.

#include <gtest/gtest.h>
#include <iio.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <thread>

#include "acquisition/iio_source.h"
#include "test_bed.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;

// Every allocation of the process, libiio's included, passes here.
namespace {
std::atomic<std::uint64_t> allocations{0};
}
extern "C" {
void *__libc_malloc(std::size_t);
void *__libc_calloc(std::size_t, std::size_t);
void *__libc_realloc(void *, std::size_t);
void *malloc(std::size_t n) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(n);
}
void *calloc(std::size_t n, std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(n, size);
}
void *realloc(void *p, std::size_t n) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(p, n);
}
}
#endif

using namespace ada;
using namespace ada::test;
using namespace std::chrono_literals;

namespace {

std::uint64_t allocations_so_far() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return 0;
#else
  return allocations.load();
#endif
}

double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Plays the kernel: `total` frames a microsecond apart, a millisecond's worth at a time.
void feed_megasamples(TestBed &bed, std::size_t total) {
  std::vector<std::byte> chunk = labelled_frames(1000, 0, 0, 1000);
  const auto began = std::chrono::steady_clock::now();
  for (std::size_t sent = 0; sent < total; sent += 1000) {
    for (std::size_t i = 0; i < 1000; ++i) {
      const auto ns = static_cast<std::int64_t>((sent + i) * 1000);
      const auto count = static_cast<std::uint16_t>(sent + i);
      std::memcpy(chunk.data() + 16 * i, &count, 2);
      std::memcpy(chunk.data() + 16 * i + 8, &ns, 8);
    }
    std::this_thread::sleep_until(began + std::chrono::microseconds(sent));
    bed.feed(chunk);
  }
}

/// libiio 0.25 and later allocate for each block themselves.
bool library_allocates() {
  unsigned int major = 0, minor = 0;
  char tag[8] = "";
  iio_library_get_version(&major, &minor, tag);
  return major > 0 || minor > 24;
}

TEST(IioRate, AMegasampleASecondStreamsWithoutLossAndWithoutAllocation) {
  if (!TestBed::available())
    GTEST_SKIP() << "umockdev's preload library is not in LD_PRELOAD";
  TestBed bed;
  BedDevice device = labelled_adc();
  device.attributes["sampling_frequency"] = "1000000";
  bed.add_device(device);
  const auto source = open_iio_source({});
  bed.connect();
  source->start();
  constexpr std::size_t kTotal = 2'000'000, kWarm = 200'000;
  std::thread kernel([&] { feed_megasamples(bed, kTotal); });

  std::vector<Frame> block(50'000);
  std::size_t got = 0, wrong = 0;
  std::uint64_t before = 0;
  const double cpu_before = thread_cpu_s();
  while (got < kTotal) {
    const ReadResult r = source->read(block, 5s);
    if (r.outcome != ReadOutcome::frames)
      break;
    for (std::size_t i = 0; i < r.count; ++i)
      wrong += block[i].vsin_v != static_cast<double>((got + i) % 65536) * (0.1 * 1e-3);
    if (got < kWarm && got + r.count >= kWarm)
      before = allocations_so_far();
    got += r.count;
  }
  const std::uint64_t allocated = allocations_so_far() - before;
  const double cpu = thread_cpu_s() - cpu_before;
  kernel.join();
  std::printf("reader: %.3f s of processor time for 2 s of samples\n", cpu);
  EXPECT_EQ(got, kTotal);
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(source->statistics().lost, 0u);
  if (library_allocates()) {
    std::printf("%llu allocations, those of this libiio among them\n",
                static_cast<unsigned long long>(allocated));
  } else if (!kSanitized) {
    EXPECT_EQ(allocated, 0u);
  }
}

} // namespace
