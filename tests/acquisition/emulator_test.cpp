// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Debian's own libiio programs against the emulated device.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>

#include "acquisition/iio_source.h"
#include "base/error.h"
#include "raw_client.h"
#include "run_program.h"
#include "served.h"
#include "simulation/emulator.h"

using namespace ada;
using namespace ada::test;
using namespace std::chrono_literals;

namespace {

SimulationOptions options(int bits = 16) {
  SimulationOptions o;
  o.sample_rate_hz = 20000.0;
  o.duration_s = 0.5;
  o.adc_bits = bits;
  return o;
}

class EmulatorTest : public ::testing::Test {
protected:
  void serve(const SimulationOptions &o) {
    simulation_ = std::make_shared<const Simulation>(std::nullopt, o, 42);
    served_ = std::make_unique<Served>(emulated_context(simulation_));
  }
  std::string u() const { return " -u " + served_->uri() + " "; }

  std::shared_ptr<const Simulation> simulation_;
  std::unique_ptr<Served> served_;
};

TEST_F(EmulatorTest, IioInfoShowsTheDeviceItsChannelsLabelsAndTrigger) {
  serve(options());
  const ProgramResult r = run_program("iio_info" + u() + "2>&1");
  EXPECT_EQ(r.status, 0) << r.output;
  for (const char *expected :
       {"Backend version: 0.24", "ada4571-sim", "voltage0:", "voltage3:", "value: vsin",
        "value: vcos", "value: vtemp", "value: vdd", "timestamp:", "format: le:U16/16>>0",
        "sampling_frequency", "trigger0", "hw_serial: simulated-42"})
    EXPECT_NE(r.output.find(expected), std::string::npos) << expected << "\n" << r.output;
  EXPECT_EQ(r.output.find("ERROR"), std::string::npos) << r.output;
}

TEST_F(EmulatorTest, IioAttrReadsAndWritesAttributes) {
  serve(options());
  EXPECT_EQ(run_program("iio_attr" + u() + "-c ada4571-sim voltage1 label").output, "vcos\n");
  EXPECT_EQ(run_program("iio_attr" + u() + "-c ada4571-sim voltage0 scale").output,
            "0.0762939453125\n");
  EXPECT_EQ(run_program("iio_attr" + u() + "-d ada4571-sim sampling_frequency").output, "20000\n");
  EXPECT_EQ(run_program("iio_attr" + u() + "-c ada4571-sim voltage0 calibbias 17 >&2").status, 0);
  EXPECT_EQ(run_program("iio_attr" + u() + "-c ada4571-sim voltage0 calibbias").output, "17\n");
  // Wrong values and read-only attributes are refused and keep what they hold.
  run_program("iio_attr" + u() + "-c ada4571-sim voltage0 calibbias rubbish 2>&1");
  EXPECT_EQ(run_program("iio_attr" + u() + "-c ada4571-sim voltage0 calibbias").output, "17\n");
  run_program("iio_attr" + u() + "-c ada4571-sim voltage0 scale 1 2>&1");
  EXPECT_EQ(run_program("iio_attr" + u() + "-c ada4571-sim voltage0 scale").output,
            "0.0762939453125\n");
}

/// Places of a count among the samples of a channel.
std::vector<std::size_t> places_of(long count, const std::vector<double> &volts, double lsb) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < volts.size(); ++i)
    if (std::lround(volts[i] / lsb) == count)
      places.push_back(i);
  return places;
}

TEST_F(EmulatorTest, RawReadingsFollowTheClock) {
  SimulationOptions o = options();
  o.duration_s = 60.0; // no reading wraps around
  o.sample_rate_hz = 1000.0;
  o.motion = "constant:rpm=10";
  serve(o);
  const Capture capture = simulation_->run();
  const auto began = std::chrono::steady_clock::now();
  const auto raw = [&] {
    return std::stol(run_program("iio_attr" + u() + "-c ada4571-sim voltage0 raw").output);
  };
  EXPECT_EQ(raw(), std::lround(capture.vsin_v[0] / (5.0 / 65536.0)));
  for (int i = 0; i < 3; ++i) {
    std::this_thread::sleep_for(100ms);
    const auto places = places_of(raw(), capture.vsin_v, 5.0 / 65536.0);
    const std::chrono::duration<double> most = std::chrono::steady_clock::now() - began;
    // At least the sleeps, at most all the time since before the first reading.
    const bool fits = std::any_of(places.begin(), places.end(), [&](std::size_t at) {
      const double t = static_cast<double>(at) / 1000.0;
      return t >= 0.1 * (i + 1) - 1e-3 && t <= most.count();
    });
    EXPECT_TRUE(fits) << i << ": " << places.size() << " places";
  }
}

TEST_F(EmulatorTest, TheRateIsOneOfThoseAvailableAndStaysWhileABufferIsOpen) {
  serve(options());
  const auto rate = [&](const std::string &value) {
    return run_program("iio_attr" + u() + "-d ada4571-sim sampling_frequency " + value + " 2>&1")
        .output;
  };
  const std::string available =
      run_program("iio_attr" + u() + "-d ada4571-sim sampling_frequency_available").output;
  EXPECT_EQ(available, "100 200 500 1000 2000 5000 10000 20000 50000 100000\n");
  rate("1234");
  EXPECT_EQ(rate(""), "20000\n");
  rate("rubbish");
  EXPECT_EQ(rate(""), "20000\n");

  IioSourceOptions o;
  o.uri = served_->uri();
  o.sample_rate_hz = 1234.0;
  try {
    open_iio_source(o);
    FAIL() << "a rate that is not available";
  } catch (const Error &e) {
    EXPECT_NE(std::string(e.what()).find("cannot be set to 1234: Invalid argument (22); it has 100 "),
              std::string::npos)
        << e.what();
  }
  o.sample_rate_hz = 1000.0;
  const auto source = open_iio_source(o);
  EXPECT_EQ(source->info().sample_rate_hz, 1000.0);
  source->start();
  std::vector<Frame> frames(100);
  std::size_t got = 0;
  while (got < frames.size()) {
    const ReadResult r = source->read(std::span(frames).subspan(got), 5s);
    ASSERT_EQ(r.outcome, ReadOutcome::frames);
    got += r.count;
  }
  EXPECT_NEAR(frames[99].time_s, 0.099, 1e-9);
  rate("20000"); // busy
  EXPECT_EQ(rate(""), "1000\n");
  source->stop();
  for (int i = 0; i < 100 && rate("") != "20000\n"; ++i) { // until the server has seen the end
    std::this_thread::sleep_for(20ms);
    rate("20000");
  }
  EXPECT_EQ(rate(""), "20000\n");
}

TEST_F(EmulatorTest, ARecordingIsADeviceWithItsVoltsItsGapsAndItsSpeed) {
  serve(options());
  auto recorded = std::make_shared<Capture>(simulation_->run());
  for (std::size_t i = 4000; i < recorded->size(); ++i)
    recorded->time_s[i] += 0.1; // 2000 frames are missing before it
  recorded->meta.serial = "S7";
  const Served replay(replayed_context(recorded, 2.0));
  IioSourceOptions o;
  o.uri = replay.uri();
  const auto source = open_iio_source(o);
  EXPECT_EQ(source->info().serial, "S7");
  EXPECT_EQ(source->info().sample_rate_hz, 40000.0);
  EXPECT_EQ(source->info().adc_bits, 16);
  source->start();
  std::vector<Frame> frames(6000);
  std::size_t got = 0;
  while (got < frames.size()) {
    const ReadResult r = source->read(std::span(frames).subspan(got), 5s);
    ASSERT_EQ(r.outcome, ReadOutcome::frames);
    got += r.count;
  }
  for (std::size_t i = 0; i < got; ++i) {
    ASSERT_DOUBLE_EQ(frames[i].vsin_v, recorded->vsin_v[i]);
    ASSERT_DOUBLE_EQ(frames[i].vcos_v, recorded->vcos_v[i]);
    ASSERT_NEAR(frames[i].vdd_v, recorded->vdd_v[i], 1e-8); // of a finer converter
    ASSERT_NEAR(frames[i].time_s, recorded->time_s[i] / 2.0, 2e-9);
  }
  EXPECT_EQ(source->statistics().lost, 2000u);
}

std::vector<Frame> read_to_the_end(Source &source) {
  std::vector<Frame> frames(20000);
  std::size_t got = 0;
  ReadResult r{ReadOutcome::frames, 0};
  while (r.outcome == ReadOutcome::frames && got < frames.size()) {
    r = source.read(std::span(frames).subspan(got), 10s);
    got += r.count;
  }
  EXPECT_EQ(r.outcome, ReadOutcome::end);
  frames.resize(got);
  return frames;
}

TEST_F(EmulatorTest, ARecordingThatIsOverEndsWithItsLastFrameAndBeginsAnewWhenStartedAgain) {
  serve(options());
  auto recorded = std::make_shared<Capture>(simulation_->run());
  const Served replay(replayed_context(recorded, 10.0));
  IioSourceOptions o;
  o.uri = replay.uri();
  o.buffer_frames = 3000; // 10000 is no multiple of it
  const auto source = open_iio_source(o);
  for (int run = 0; run < 2; ++run) {
    source->start();
    const std::vector<Frame> frames = read_to_the_end(*source);
    ASSERT_EQ(frames.size(), recorded->size());
    for (std::size_t i = 0; i < frames.size(); ++i)
      ASSERT_DOUBLE_EQ(frames[i].vsin_v, recorded->vsin_v[i]);
    Frame frame;
    EXPECT_EQ(source->read({&frame, 1}, 1s).outcome, ReadOutcome::end) << "it stays over";
  }
}

TEST_F(EmulatorTest, ASimulationOfLimitedDurationEnds) {
  serve(options());
  IioSourceOptions o;
  o.uri = served_->uri();
  const auto source = open_iio_source(o);
  source->start();
  EXPECT_EQ(read_to_the_end(*source).size(), 10000u);
}

TEST_F(EmulatorTest, ABufferThatTimesOutInAGapIsGoneOnWith) {
  serve(options());
  auto recorded = std::make_shared<Capture>(simulation_->run());
  for (std::size_t i = 4100; i < recorded->size(); ++i)
    recorded->time_s[i] += 3.0; // the server's patience is half of the client's five seconds
  const Served replay(replayed_context(recorded, 1.0));
  IioSourceOptions o;
  o.uri = replay.uri();
  const auto source = open_iio_source(o);
  source->start();
  const std::vector<Frame> frames = read_to_the_end(*source);
  ASSERT_EQ(frames.size(), recorded->size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_DOUBLE_EQ(frames[i].vsin_v, recorded->vsin_v[i]) << i;
    ASSERT_NEAR(frames[i].time_s, recorded->time_s[i], 2e-9) << i;
  }
  EXPECT_EQ(source->statistics().lost, 60000u);
}

/// One frame of one channel of served_pair(), through a buffer of its own.
class OneFrame {
public:
  OneFrame(const Served &server, const std::string &mask) : fd_(connect_to(server.port())) {
    EXPECT_EQ(ask("OPEN iio:device0 1 " + mask), "0");
  }
  std::string ask(const std::string &command) {
    say(fd_, command + "\r\n");
    return answer_line(fd_);
  }
  /// -1 for a refusal.
  int read() {
    EXPECT_EQ(ask("TIMEOUT 0"), "0");
    if (ask("READBUF iio:device0 2") != "2")
      return -1;
    answer_line(fd_); // the mask
    unsigned char bytes[2] = {};
    EXPECT_EQ(recv(fd_.get(), bytes, 2, MSG_WAITALL), 2);
    return bytes[0] + 256 * bytes[1];
  }
  void time_out() {
    EXPECT_EQ(ask("TIMEOUT 1"), "0");
    EXPECT_EQ(ask("READBUF iio:device0 2"), "-" + std::to_string(ETIMEDOUT));
  }

private:
  Descriptor fd_;
};

TEST(LeftRuns, BelongToTheClientThatTimedOutAndToNoNewOne) {
  ScanFormat u16;
  u16.bits = u16.storage = 16;
  // A second from frame to frame: what is to time out within one must also do so on a busy machine.
  const Served server(served_pair(u16, u16, 1.0, false, 4)); // counts 1, 2, 3, 4 and 0, 3, 6, 9
  OneFrame first(server, "00000001"), other(server, "00000002");
  EXPECT_EQ(first.read(), 1);
  EXPECT_EQ(other.read(), 0);
  first.time_out();
  EXPECT_EQ(first.read(), -1) << "that buffer is of no use any more";
  other.time_out();
  OneFrame second(server, "00000001"), third(server, "00000001"), another(server, "00000002");
  EXPECT_EQ(second.read(), 2);
  EXPECT_EQ(third.read(), 1) << "there is one to be taken only";
  EXPECT_EQ(another.read(), 3);
  second.time_out();
  const Descriptor fresh = connect_to(server.port());
  say(fresh, "PRINT\r\n"); // as every new client begins
  answer_line(fresh);
  OneFrame fourth(server, "00000001");
  EXPECT_EQ(fourth.read(), 1);
  for (const int count : {6, 9})
    EXPECT_EQ(another.read(), count);
  EXPECT_EQ(another.ask("READBUF iio:device0 2"), "-" + std::to_string(ENODATA));
  EXPECT_EQ(another.ask("READBUF iio:device0 2"), "-" + std::to_string(ENODATA)) << "for good";
}

/// Little-endian word at p.
std::uint64_t word(const char *p, unsigned bytes) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bytes; ++i)
    value |= std::uint64_t{static_cast<unsigned char>(p[i])} << (8 * i);
  return value;
}

TEST_F(EmulatorTest, IioReaddevGetsEverySampleBitForBit) {
  for (const int bits : {12, 16, 24}) {
    serve(options(bits));
    const Capture capture = simulation_->run();
    const ProgramResult r =
        run_program("iio_readdev" + u() + "-b 500 -s 4000 ada4571-sim 2>/dev/null");
    const unsigned w = bits <= 16 ? 2 : 4;
    const std::size_t frame = 4 * w + 8;
    ASSERT_EQ(r.output.size(), 4000 * frame) << bits;
    const double lsb = 5.0 / std::ldexp(1.0, bits);
    std::int64_t first_ns = 0;
    for (std::size_t i = 0; i < 4000; ++i) {
      const char *p = r.output.data() + i * frame;
      ASSERT_EQ(word(p, w), std::llround(capture.vsin_v[i] / lsb)) << i;
      ASSERT_EQ(word(p + w, w), std::llround(capture.vcos_v[i] / lsb)) << i;
      const auto ns = static_cast<std::int64_t>(word(p + 4 * w, 8));
      first_ns = i == 0 ? ns : first_ns;
      ASSERT_EQ(ns - first_ns, static_cast<std::int64_t>(i) * 50000) << i;
    }
  }
}

TEST_F(EmulatorTest, ASubsetOfChannelsIsLaidOutAsTheKernelDoes) {
  serve(options());
  const Capture capture = simulation_->run();
  const ProgramResult r = run_program("iio_readdev" + u() +
                                      "-b 500 -s 1000 ada4571-sim voltage1 timestamp 2>/dev/null");
  ASSERT_EQ(r.output.size(), 1000u * 16u); // u16, six bytes of padding, s64
  for (std::size_t i = 0; i < 1000; ++i)
    ASSERT_EQ(word(r.output.data() + 16 * i, 2), std::llround(capture.vcos_v[i] / (5.0 / 65536.0)));
}

TEST_F(EmulatorTest, ServesSeveralClientsAtOnceEachFromTheBeginning) {
  serve(options());
  const std::string command =
      "iio_readdev" + u() + "-b 400 -s 4000 ada4571-sim voltage0 2>/dev/null";
  ProgramResult other;
  std::thread parallel([&] { other = run_program(command); });
  const ProgramResult one = run_program(command);
  parallel.join();
  EXPECT_EQ(one.output.size(), 8000u);
  EXPECT_EQ(one.output, other.output);
}

TEST_F(EmulatorTest, PacesTheStreamByTheSampleRate) {
  serve(options());
  const auto began = std::chrono::steady_clock::now();
  run_program("iio_readdev" + u() + "-b 1000 -s 8000 ada4571-sim voltage0 2>/dev/null");
  const auto took = std::chrono::steady_clock::now() - began;
  EXPECT_GE(took, 400ms); // 8000 frames at 20 kS/s
}

TEST_F(EmulatorTest, OurOwnSourceReadsTheSimulatedVolts) {
  serve(options());
  const Capture capture = simulation_->run();
  IioSourceOptions o;
  o.uri = served_->uri();
  const auto source = open_iio_source(o);
  EXPECT_EQ(source->info().serial, "simulated-42");
  EXPECT_EQ(source->info().sample_rate_hz, 20000.0);
  EXPECT_TRUE(source->info().has_vtemp);
  EXPECT_TRUE(source->info().has_vdd);
  source->start();
  std::vector<Frame> frames(4000);
  std::size_t got = 0;
  while (got < frames.size()) {
    const ReadResult r = source->read(std::span(frames).subspan(got), 60s);
    ASSERT_EQ(r.outcome, ReadOutcome::frames);
    got += r.count;
  }
  for (std::size_t i = 0; i < got; ++i) {
    ASSERT_DOUBLE_EQ(frames[i].vsin_v, capture.vsin_v[i]);
    ASSERT_DOUBLE_EQ(frames[i].vcos_v, capture.vcos_v[i]);
    ASSERT_NEAR(frames[i].vdd_v, capture.vdd_v[i], 5.0 / 65536.0 + 1e-12); // half a count of 2 lsb
    ASSERT_NEAR(frames[i].time_s, static_cast<double>(i) / 20000.0, 1e-9);
  }
  EXPECT_EQ(source->statistics().lost, 0u);
}

TEST_F(EmulatorTest, APortInUseIsRefusedWithAReason) {
  serve(options());
  try {
    Emulator second(emulated_context(simulation_), served_->port());
    FAIL() << "no error";
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_BUSY);
    EXPECT_NE(std::string(e.what()).find("in use"), std::string::npos);
  }
}

TEST_F(EmulatorTest, StopEndsTheServerWhileAClientStreams) {
  serve(options());
  IioSourceOptions o;
  o.uri = served_->uri();
  const auto source = open_iio_source(o);
  source->start();
  Frame frame;
  ASSERT_EQ(source->read({&frame, 1}, 60s).outcome, ReadOutcome::frames);
  served_->die(); // returns, though the client has not ended
}

} // namespace
