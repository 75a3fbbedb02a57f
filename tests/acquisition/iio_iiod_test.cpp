// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The network backend against Debian's own iiod, which serves a make-believe machine.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <functional>
#include <thread>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "acquisition/iio_source.h"
#include "base/error.h"
#include "test_bed.h"

using namespace ada;
using namespace ada::test;
using namespace std::chrono_literals;

namespace {

constexpr const char *kIiod = "/usr/sbin/iiod";

int free_port() {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(fd, reinterpret_cast<sockaddr *>(&address), size);
  getsockname(fd, reinterpret_cast<sockaddr *>(&address), &size);
  close(fd);
  return ntohs(address.sin_port);
}

/// A program of our own, ended by its id.
class Child {
public:
  Child(std::vector<std::string> arguments, const char *preload) {
    std::vector<char *> argv;
    for (std::string &a : arguments)
      argv.push_back(a.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      const int null = open("/dev/null", O_RDWR);
      dup2(null, 0);
      dup2(null, 1);
      dup2(null, 2);
      if (preload)
        setenv("LD_PRELOAD", preload, 1);
      else
        unsetenv("LD_PRELOAD");
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Child() { kill(); }
  void kill() {
    if (pid_ <= 0)
      return;
    ::kill(pid_, SIGKILL); // iiod takes its time over SIGTERM
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

private:
  pid_t pid_;
};

class IioIiod : public ::testing::Test {
protected:
  void SetUp() override {
    if (!TestBed::available())
      GTEST_SKIP() << "umockdev's preload library is not in LD_PRELOAD";
    if (!std::filesystem::exists(kIiod))
      GTEST_SKIP() << "Debian's package iiod is not installed";
    bed_ = std::make_unique<TestBed>();
  }

  void serve() {
    port_ = port_ ? port_ : free_port();
    iiod_ = std::make_unique<Child>(std::vector<std::string>{kIiod, "-p", std::to_string(port_)},
                                    "libumockdev-preload.so.0");
    uri_ = "ip:127.0.0.1:" + std::to_string(port_);
  }

  std::unique_ptr<IioSource> open_source(std::size_t buffer_frames = 0) {
    IioSourceOptions o;
    o.uri = uri_;
    o.buffer_frames = buffer_frames;
    for (int attempt = 0;; ++attempt) {
      try {
        return open_iio_source(o);
      } catch (const Error &) {
        if (attempt == 100)
          throw;
      }
      std::this_thread::sleep_for(50ms);
    }
  }

  static std::vector<Frame> read_frames(Source &source, std::size_t count,
                                        std::chrono::milliseconds timeout = 60s) {
    std::vector<Frame> frames(count);
    std::size_t got = 0;
    while (got < count) {
      const ReadResult r = source.read(std::span(frames).subspan(got), timeout);
      if (r.outcome != ReadOutcome::frames)
        break;
      got += r.count;
    }
    frames.resize(got);
    return frames;
  }

  std::unique_ptr<TestBed> bed_;
  std::unique_ptr<Child> iiod_;
  int port_ = 0;
  std::string uri_;
};

TEST_F(IioIiod, DiscoversByLabelAndReadsFrames) {
  bed_->add_device(labelled_adc());
  serve();
  const auto source = open_source();
  const auto list = list_iio_devices(uri_);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_TRUE(list[0].labelled);
  EXPECT_EQ(list[0].channels, "voltage0 (vsin), voltage1 (vcos), voltage2 (vtemp)");
  bed_->connect();
  source->start();
  bed_->feed(labelled_frames(1000, 10, 0, 1'000'000));
  const auto frames = read_frames(*source, 1000);
  ASSERT_EQ(frames.size(), 1000u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_EQ(frames[i].vsin_v, (10.0 + double(i)) * (0.1 * 1e-3));
    ASSERT_NEAR(frames[i].time_s, double(i) * 1e-3, 1e-12);
  }
}

TEST_F(IioIiod, ASilenceLongerThanTheServersTimeoutEndsNothing) {
  // The server gives up a refill after half of the client's five seconds, and 0.24's buffer is
  // useless from then on.
  bed_->add_device(labelled_adc());
  serve();
  const auto source = open_source();
  bed_->connect();
  source->start();
  bed_->feed(labelled_frames(50, 0, 0, 1'000'000));
  ASSERT_EQ(read_frames(*source, 50).size(), 50u);
  Frame frame;
  EXPECT_EQ(source->read({&frame, 1}, 3500ms).outcome, ReadOutcome::timeout);
  bed_->feed(labelled_frames(500, 4000, 4'000'000'000, 1'000'000));
  const auto frames = read_frames(*source, 200);
  ASSERT_EQ(frames.size(), 200u);
  EXPECT_GE(frames[0].vsin_v, 4000 * (0.1 * 1e-3));
  for (std::size_t i = 1; i < frames.size(); ++i)
    ASSERT_NEAR(frames[i].vsin_v - frames[i - 1].vsin_v, 0.1 * 1e-3, 1e-12);
  EXPECT_GE(source->statistics().lost, 3900u);
  EXPECT_GE(source->statistics().gaps, 1u);
}

TEST_F(IioIiod, ChannelsThatAnotherClientEnabledAreSkipped) {
  // iiod sends every client all channels that any of them has enabled.
  BedDevice device = labelled_adc(); // ours are the second and the third, and the timestamp
  device.channels[0].attributes.erase("label");
  device.channels[1].attributes["label"] = "vsin";
  device.channels[2].attributes["label"] = "vcos";
  bed_->add_device(device);
  serve();
  const auto source = open_source(48);
  EXPECT_FALSE(source->info().has_vtemp);
  bed_->connect();
  // Frames of all four channels flow all the time, since iiod starts a second client only between
  // two refills of the first. 48 times 2, 16 or 24 bytes end at a frame of 16.
  std::atomic<bool> done{false};
  std::thread feeder([&] {
    for (std::uint16_t n = 100; !done; n = static_cast<std::uint16_t>(n + 12)) {
      bed_->feed(labelled_frames(12, n, n * std::int64_t{1'000'000}, 1'000'000));
      std::this_thread::sleep_for(5ms);
    }
  });
  Child other({"/usr/bin/iio_readdev", "-u", uri_, "-b", "48", "fake-adc", "voltage0"}, nullptr);
  while (bed_->read("scan_elements/in_voltage0_en") != "1")
    std::this_thread::sleep_for(5ms);
  std::vector<Frame> frames;
  EXPECT_NO_THROW(source->start());
  EXPECT_NO_THROW(frames = read_frames(*source, 1000));
  done = true;
  feeder.join();
  EXPECT_EQ(bed_->read("scan_elements/in_voltage0_en"), "1"); // by the other
  ASSERT_EQ(frames.size(), 1000u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_GE(frames[i].vsin_v, 200 * (0.1 * 1e-3)) << i;
    ASSERT_EQ(frames[i].vcos_v, 7 * (0.1 * 1e-3)) << i;
    ASSERT_NEAR(frames[i].time_s, (frames[i].vsin_v - frames[0].vsin_v) * 5, 1e-9) << i;
    ASSERT_TRUE(std::isnan(frames[i].vtemp_v));
  }
}

TEST_F(IioIiod, DeathOfTheServerIsReportedAndStartOpensAgain) {
  bed_->add_device(labelled_adc());
  serve();
  const auto source = open_source();
  source->start();
  std::thread death([&] {
    std::this_thread::sleep_for(200ms);
    iiod_->kill();
  });
  Frame frame;
  try {
    source->read({&frame, 1}, -1ms);
    ADD_FAILURE() << "no error";
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_DISCONNECTED) << e.what();
    EXPECT_NE(std::string(e.what()).find("server"), std::string::npos) << e.what();
  }
  death.join();
  EXPECT_THROW(source->start(), Error);

  serve();
  for (int attempt = 0; attempt < 100; ++attempt) {
    try {
      source->start();
      break;
    } catch (const Error &e) {
      ASSERT_EQ(e.status(), ADA4571_ERROR_DISCONNECTED) << e.what();
    }
    std::this_thread::sleep_for(50ms);
  }
  bed_->connect();
  bed_->feed(labelled_frames(100, 0, 0, 1'000'000));
  EXPECT_EQ(read_frames(*source, 50).size(), 50u);
}

TEST_F(IioIiod, CancelReturnsAtOnce) {
  bed_->add_device(labelled_adc());
  serve();
  const auto source = open_source();
  source->start();
  std::thread other([&] {
    std::this_thread::sleep_for(200ms);
    source->cancel();
  });
  Frame frame;
  EXPECT_EQ(source->read({&frame, 1}, -1ms).outcome, ReadOutcome::cancelled); // which has no end
  other.join();
}

TEST_F(IioIiod, DriverCalibrationGoesThroughTheServer) {
  BedDevice device = labelled_adc();
  device.channels[0].attributes["calibbias"] = "0";
  bed_->add_device(device);
  serve();
  const auto source = open_source();
  DriverCalibration c;
  c.sin.bias = 42;
  source->write_driver_calibration(c);
  EXPECT_EQ(bed_->read("in_voltage0_calibbias"), "42");
  EXPECT_EQ(source->read_driver_calibration().sin.bias, 42.0);
}

} // namespace
