// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The local backend of the real libiio on a make-believe /sys and /dev.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <thread>

#include <unistd.h>

#include "acquisition/iio_source.h"
#include "base/error.h"
#include "test_bed.h"

using namespace ada;
using namespace ada::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

class IioLocal : public ::testing::Test {
protected:
  void SetUp() override {
    if (!TestBed::available())
      GTEST_SKIP() << "umockdev's preload library is not in LD_PRELOAD";
    bed_ = std::make_unique<TestBed>();
  }

  /// Reads until `count` frames are there or nothing comes for a second.
  static std::vector<Frame> read_frames(Source &source, std::size_t count) {
    std::vector<Frame> frames(count);
    std::size_t got = 0;
    while (got < count) {
      const ReadResult r = source.read(std::span(frames).subspan(got), 1s);
      if (r.outcome != ReadOutcome::frames)
        break;
      got += r.count;
    }
    frames.resize(got);
    return frames;
  }

  static ada4571_status status_of(const std::function<void()> &action,
                                  std::string *text = nullptr) {
    try {
      action();
    } catch (const Error &e) {
      if (text)
        *text = e.what();
      return e.status();
    }
    return ADA4571_OK;
  }

  std::unique_ptr<TestBed> bed_;
};

TEST_F(IioLocal, ListsDevicesWithAUsablePairAndTheirLabels) {
  bed_->add_device(labelled_adc());
  BedDevice unlabelled;
  unlabelled.name = "plain-adc";
  unlabelled.channels = {{"voltage0", "le:u16/16>>0", {{"scale", "1"}, {"raw", "0"}}},
                         {"voltage1", "le:u16/16>>0", {{"scale", "1"}, {"raw", "0"}}}};
  bed_->add_device(unlabelled);
  BedDevice single;
  single.channels = {{"voltage0", "le:u16/16>>0", {{"scale", "1"}, {"raw", "0"}}}};
  bed_->add_device(single);

  const auto list = list_iio_devices("local:");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].device.id, "iio:device0");
  EXPECT_EQ(list[0].device.name, "fake-adc");
  EXPECT_EQ(list[0].channels, "voltage0 (vsin), voltage1 (vcos), voltage2 (vtemp)");
  EXPECT_TRUE(list[0].labelled);
  EXPECT_EQ(list[0].sin, "voltage0");
  EXPECT_EQ(list[0].cos, "voltage1");
  EXPECT_EQ(list[0].temp, "voltage2");
  EXPECT_EQ(list[0].vdd, "");
  EXPECT_FALSE(list[1].labelled);
  EXPECT_EQ(list[1].sin, "");
}

TEST_F(IioLocal, ReadsFramesInVoltsWithTimesFromTheTimestamps) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  EXPECT_TRUE(source->info().has_vtemp);
  EXPECT_FALSE(source->info().has_vdd);
  EXPECT_EQ(source->info().sample_rate_hz, 1000.0);
  EXPECT_EQ(source->info().adc_bits, 16);
  bed_->connect();
  source->start();
  bed_->feed(labelled_frames(300, 1000, 5'000'000'000, 1'000'000));
  const auto frames = read_frames(*source, 300);
  ASSERT_EQ(frames.size(), 300u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].vsin_v, (1000.0 + double(i)) * (0.1 * 1e-3));
    EXPECT_EQ(frames[i].vcos_v, (2000.0 + 2.0 * double(i)) * (0.1 * 1e-3));
    EXPECT_EQ(frames[i].vtemp_v, 7.0 * (0.1 * 1e-3));
    EXPECT_TRUE(std::isnan(frames[i].vdd_v));
    EXPECT_TRUE(std::isnan(frames[i].reference_deg));
    EXPECT_NEAR(frames[i].time_s, double(i) * 1e-3, 1e-12);
  }
  EXPECT_EQ(source->statistics().frames, 300u);
  EXPECT_EQ(source->statistics().lost, 0u);
}

TEST_F(IioLocal, SetsUpTheKernelBufferAndTheChannels) {
  bed_->add_device(labelled_adc());
  bed_->write("current_timestamp_clock", "realtime");
  const auto source = open_iio_source({});
  source->start();
  EXPECT_EQ(bed_->read("scan_elements/in_voltage0_en"), "1");
  EXPECT_EQ(bed_->read("scan_elements/in_voltage1_en"), "1");
  EXPECT_EQ(bed_->read("scan_elements/in_voltage2_en"), "1");
  EXPECT_EQ(bed_->read("scan_elements/in_timestamp_en"), "1");
  EXPECT_EQ(bed_->read("buffer/enable"), "1");
  EXPECT_EQ(bed_->read("buffer/watermark"), "50"); // a twentieth of a second at 1 kS/s
  EXPECT_EQ(bed_->read("buffer/length"), "1000");  // a second for a reader that is late
  EXPECT_EQ(bed_->read("current_timestamp_clock"), "monotonic");
  source->stop();
  EXPECT_EQ(bed_->read("buffer/enable"), "0");
}

TEST_F(IioLocal, AFrameCutByAShortReadIsCompletedFromTheNext) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  bed_->connect();
  source->start();
  const auto bytes = labelled_frames(64, 1, 0, 1'000'000);
  // Pieces of 1, 3, 5, ... bytes, each read before the next is written.
  std::vector<Frame> frames, block(64);
  std::size_t sent = 0;
  for (std::size_t piece = 1; sent < bytes.size(); piece += 2) {
    const std::size_t n = std::min(piece, bytes.size() - sent);
    bed_->feed(std::span(bytes).subspan(sent, n));
    sent += n;
    const ReadResult r = source->read(block, 0ms);
    frames.insert(frames.end(), block.begin(), block.begin() + static_cast<long>(r.count));
    EXPECT_LE(frames.size(), sent / 16);
  }
  while (frames.size() < 64) {
    const ReadResult r = source->read(block, 200ms);
    ASSERT_EQ(r.outcome, ReadOutcome::frames);
    frames.insert(frames.end(), block.begin(), block.begin() + static_cast<long>(r.count));
  }
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_EQ(frames[i].vsin_v, (1.0 + double(i)) * (0.1 * 1e-3));
    EXPECT_NEAR(frames[i].time_s, double(i) * 1e-3, 1e-12);
  }
  EXPECT_EQ(source->statistics().lost, 0u);
}

TEST_F(IioLocal, ATimeoutIsOrdinaryAndLosesNothing) {
  // libiio 0.24 in blocking mode loses what a refill had read before its time-out.
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  bed_->connect();
  source->start();
  std::vector<Frame> block(100), frames;
  std::uint16_t next = 1;
  for (int round = 0; round < 4; ++round) {
    // Fewer than a buffer of 50: each round ends in a time-out.
    bed_->feed(labelled_frames(7, next, (next - 1) * 1'000'000, 1'000'000));
    next = static_cast<std::uint16_t>(next + 7);
    for (;;) {
      const auto began = Clock::now();
      const ReadResult r = source->read(block, 120ms);
      if (r.outcome == ReadOutcome::timeout) {
        EXPECT_EQ(r.count, 0u);
        EXPECT_GE(Clock::now() - began, 120ms);
        break;
      }
      frames.insert(frames.end(), block.begin(), block.begin() + static_cast<long>(r.count));
    }
  }
  ASSERT_EQ(frames.size(), 28u);
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_EQ(frames[i].vsin_v, (1.0 + double(i)) * (0.1 * 1e-3));
  EXPECT_EQ(source->statistics().lost, 0u);
}

TEST_F(IioLocal, ATimeoutOfZeroLooksOnce) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  source->start();
  Frame frame;
  EXPECT_EQ(source->read({&frame, 1}, 0ms).outcome, ReadOutcome::timeout);
}

TEST_F(IioLocal, CancelEndsAReadWithoutTimeoutAtOnceAndStartBeginsAnew) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  source->start();
  std::thread other([&] {
    std::this_thread::sleep_for(150ms);
    source->cancel();
  });
  Frame frame;
  EXPECT_EQ(source->read({&frame, 1}, -1ms).outcome, ReadOutcome::cancelled); // which has no end
  other.join();
  EXPECT_EQ(source->read({&frame, 1}, -1ms).outcome, ReadOutcome::cancelled); // and stays so

  bed_->connect();
  source->start();
  bed_->feed(labelled_frames(1, 5, 0, 1));
  EXPECT_EQ(source->read({&frame, 1}, 60s).outcome, ReadOutcome::frames);
  EXPECT_EQ(frame.vsin_v, 5.0 * (0.1 * 1e-3));
}

TEST_F(IioLocal, ReadBeforeStartIsTheWrongMoment) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  Frame frame;
  EXPECT_EQ(status_of([&] { source->read({&frame, 1}, 0ms); }), ADA4571_ERROR_STATE);
  source->start();
  source->stop();
  EXPECT_EQ(status_of([&] { source->read({&frame, 1}, 0ms); }), ADA4571_ERROR_STATE);
}

TEST_F(IioLocal, ARemovedDeviceIsReportedAndOpensAgainWhenItIsBack) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  source->start();
  std::thread unplug([&] {
    std::this_thread::sleep_for(100ms);
    bed_->remove_device();
  });
  Frame frame;
  std::string text;
  EXPECT_EQ(status_of([&] { source->read({&frame, 1}, -1ms); }, &text), ADA4571_ERROR_DISCONNECTED);
  EXPECT_NE(text.find("fake-adc (iio:device0) was removed"), std::string::npos) << text;
  unplug.join();

  EXPECT_EQ(status_of([&] { source->start(); }, &text), ADA4571_ERROR_DISCONNECTED) << text;

  bed_->add_device(labelled_adc()); // comes back under another number
  bed_->connect(1);
  source->start();
  bed_->feed(labelled_frames(1, 9, 0, 1));
  EXPECT_EQ(source->read({&frame, 1}, 60s).outcome, ReadOutcome::frames);
  EXPECT_EQ(frame.vsin_v, 9.0 * (0.1 * 1e-3));
}

TEST_F(IioLocal, LostFramesAreCountedFromTheTimestamps) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  bed_->connect();
  source->start();
  bed_->feed(labelled_frames(200, 0, 0, 1'000'000));
  bed_->feed(labelled_frames(200, 237, 237'000'000, 1'000'000)); // 37 frames are missing
  ASSERT_EQ(read_frames(*source, 400).size(), 400u);
  EXPECT_EQ(source->statistics().lost, 37u);
  EXPECT_EQ(source->statistics().gaps, 1u);
}

TEST_F(IioLocal, AScanThatLibiioMeasuresWronglyIsReadRight) {
  // Without a timestamp, a u32 and a u16: libiio 0.24 believes in frames of 6 bytes, the kernel
  // writes 8.
  BedDevice device;
  device.channels = {{"voltage0", "le:u32/32>>0", {{"label", "vsin"}, {"scale", "1"}}},
                     {"voltage1", "le:u16/16>>0", {{"label", "vcos"}, {"scale", "1"}}}};
  device.attributes["sampling_frequency"] = "100";
  bed_->add_device(device);
  const auto source = open_iio_source({});
  bed_->connect();
  source->start();
  FrameWriter writer;
  for (unsigned i = 0; i < 500; ++i)
    writer.put(100000 + i, 4).put(i, 2).end(8);
  bed_->feed(writer.bytes());
  const auto frames = read_frames(*source, 500);
  ASSERT_EQ(frames.size(), 500u);
  for (std::size_t i = 0; i < 500; ++i) {
    ASSERT_EQ(frames[i].vsin_v, (100000.0 + double(i)) * 1e-3);
    ASSERT_EQ(frames[i].vcos_v, double(i) * 1e-3);
    ASSERT_DOUBLE_EQ(frames[i].time_s, double(i) / 100.0); // by the rate
  }
}

TEST_F(IioLocal, FormatsOfEveryKindInOneScan) {
  BedDevice device;
  device.channels = {
      {"voltage0", "be:s12/16>>4", {{"label", "vcos"}, {"scale", "2"}, {"offset", "100"}}},
      {"voltage1", "le:s24/32>>8", {{"label", "vsin"}, {"scale", "0.5"}, {"offset", "-7"}}},
      {"voltage2", "le:u8/8>>0", {{"label", "vtemp"}, {"scale", "10"}}},
      {"voltage3", "be:u16/16X2>>0", {{"label", "vdd"}, {"scale", "1"}}},
      {"timestamp", "be:s64/64>>0", {}}};
  bed_->add_device(device);
  const auto source = open_iio_source({});
  bed_->connect();
  source->start();
  FrameWriter writer;
  for (int i = -50; i < 50; ++i) {
    const auto u = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
    writer.put(u(i * 16) | 0xf, 2, true); // the low four bits are not ours
    writer.put(u(i * 100 * 256) | 0xff, 4);
    writer.put(u(i + 100), 1);
    writer.put(0, 1).end(4).put(u(4000 + i), 2, true).put(u(5000 + i), 2, true).end(8);
    writer.put(u(1'000'000'000 + i * std::int64_t{1'000'000}), 8, true);
  }
  bed_->feed(writer.bytes());
  const auto frames = read_frames(*source, 100);
  ASSERT_EQ(frames.size(), 100u);
  for (std::size_t k = 0; k < 100; ++k) {
    const double i = double(k) - 50;
    EXPECT_EQ(frames[k].vcos_v, (i + 100) * (2 * 1e-3));
    EXPECT_EQ(frames[k].vsin_v, (i * 100 - 7) * (0.5 * 1e-3));
    EXPECT_EQ(frames[k].vtemp_v, (i + 100) * (10 * 1e-3));
    EXPECT_EQ(frames[k].vdd_v, (4500 + i) * 1e-3);
    EXPECT_NEAR(frames[k].time_s, double(k) * 1e-3, 1e-12);
  }
}

TEST_F(IioLocal, ChannelsAreChosenByIdByLabelOrByName) {
  bed_->add_device(labelled_adc());
  for (const char *sin : {"voltage2", "vtemp"}) {
    IioSourceOptions o;
    o.channels.sin = sin;
    o.channels.cos = "vsin";
    o.channels.temp = "voltage1";
    const auto source = open_iio_source(o);
    bed_->connect();
    source->start();
    bed_->feed(labelled_frames(1, 3, 0, 1));
    Frame frame;
    ASSERT_EQ(source->read({&frame, 1}, 60s).outcome, ReadOutcome::frames);
    EXPECT_EQ(frame.vsin_v, 7 * (0.1 * 1e-3));
    EXPECT_EQ(frame.vcos_v, 3 * (0.1 * 1e-3));
    EXPECT_EQ(frame.vtemp_v, 6 * (0.1 * 1e-3));
  }
}

TEST_F(IioLocal, WrongChoicesAreRefusedWithWhatThereIs) {
  bed_->add_device(labelled_adc());
  std::string text;
  IioSourceOptions o;
  o.device = "nonsense";
  EXPECT_EQ(status_of([&] { open_iio_source(o); }, &text), ADA4571_ERROR_NOT_FOUND);
  EXPECT_NE(text.find("fake-adc (iio:device0)"), std::string::npos) << text;
  o = {};
  o.channels.sin = "voltage9";
  o.device = "fake-adc";
  EXPECT_EQ(status_of([&] { open_iio_source(o); }, &text), ADA4571_ERROR_NOT_FOUND);
  EXPECT_NE(text.find("voltage0 (vsin), voltage1 (vcos)"), std::string::npos) << text;
  o.channels.sin = "voltage1";
  EXPECT_EQ(status_of([&] { open_iio_source(o); }, &text), ADA4571_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(text.find("two signals"), std::string::npos) << text;
  o.channels.sin = "timestamp";
  EXPECT_EQ(status_of([&] { open_iio_source(o); }, &text), ADA4571_ERROR_UNSUPPORTED);
  bed_->add_device(labelled_adc());
  EXPECT_EQ(status_of([&] { open_iio_source({}); }, &text), ADA4571_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(text.find("several"), std::string::npos) << text;
}

TEST_F(IioLocal, WrongAttributesAreNamedWithTheirText) {
  struct Case {
    const char *attribute, *value;
    ada4571_status status;
    const char *expected;
  };
  for (const Case &c :
       {Case{"in_voltage0_scale", "rubbish", ADA4571_ERROR_FORMAT, "\"rubbish\" is not a number"},
        Case{"in_voltage1_scale", "", ADA4571_ERROR_FORMAT, "voltage1, attribute scale"},
        Case{"in_voltage1_scale", "0", ADA4571_ERROR_FORMAT, "greater than 0"},
        Case{"in_voltage1_scale", "-1", ADA4571_ERROR_FORMAT, "greater than 0"},
        Case{"in_voltage1_scale", "nan", ADA4571_ERROR_FORMAT, "not a number"},
        Case{"in_voltage0_offset", "1.5 V", ADA4571_ERROR_FORMAT, "attribute offset"},
        Case{"sampling_frequency", "fast", ADA4571_ERROR_FORMAT, "sampling_frequency"},
        Case{"scan_elements/in_voltage0_type", "le:u17/16>>0", ADA4571_ERROR_UNSUPPORTED,
             "voltage0"},
        Case{"scan_elements/in_voltage1_type", "le:u12/16>>8", ADA4571_ERROR_UNSUPPORTED,
             "do not fit"}}) {
    TestBed bed;
    bed.add_device(labelled_adc());
    bed.write(c.attribute, c.value);
    std::string text;
    EXPECT_EQ(status_of([&] { open_iio_source({}); }, &text), c.status) << c.attribute << text;
    EXPECT_NE(text.find(c.expected), std::string::npos) << c.attribute << ": " << text;
  }
}

TEST_F(IioLocal, AChannelWithoutScaleCannotBecomeVolts) {
  BedDevice device = labelled_adc();
  device.channels[1].attributes.erase("scale");
  bed_->add_device(device);
  std::string text;
  EXPECT_EQ(status_of([&] { open_iio_source({}); }, &text), ADA4571_ERROR_UNSUPPORTED);
  EXPECT_NE(text.find("voltage1"), std::string::npos) << text;
}

TEST_F(IioLocal, ADeviceWithoutTimestampsAndRateAsksForTheRate) {
  BedDevice device = labelled_adc();
  device.channels.pop_back();
  device.attributes.clear();
  bed_->add_device(device);
  std::string text;
  EXPECT_EQ(status_of([&] { open_iio_source({}); }, &text), ADA4571_ERROR_UNSUPPORTED);
  EXPECT_NE(text.find("give the sample rate"), std::string::npos) << text;
  IioSourceOptions o;
  o.sample_rate_hz = 250.0;
  EXPECT_EQ(open_iio_source(o)->info().sample_rate_hz, 250.0);
}

TEST_F(IioLocal, TheTriggerIsSetBeforeTheBufferAndItsRateIsTheRate) {
  bed_->add_device(labelled_adc());
  bed_->add_trigger("timer-a", {{"sampling_frequency", "100"}});
  bed_->add_trigger("timer-b", {{"sampling_frequency", "4000"}});
  IioSourceOptions o;
  o.trigger = "timer-b";
  const auto source = open_iio_source(o);
  EXPECT_EQ(bed_->read("trigger/current_trigger"), "timer-b");
  EXPECT_EQ(source->info().sample_rate_hz, 4000.0);
  EXPECT_EQ(bed_->read("buffer/enable"), "0");

  o.trigger = "timer-c";
  std::string text;
  EXPECT_EQ(status_of([&] { open_iio_source(o); }, &text), ADA4571_ERROR_NOT_FOUND);
  EXPECT_NE(text.find("no IIO trigger \"timer-c\""), std::string::npos) << text;
}

TEST_F(IioLocal, ARefusedTriggerIsReportedWithTheReasonOfTheKernel) {
  bed_->add_device(labelled_adc());
  bed_->add_trigger("timer", {});
  std::filesystem::remove(bed_->sysfs() / "trigger/current_trigger");
  std::filesystem::create_directory(bed_->sysfs() / "trigger/current_trigger"); // EISDIR
  IioSourceOptions o;
  o.trigger = "timer";
  std::string text;
  EXPECT_EQ(status_of([&] { open_iio_source(o); }, &text), ADA4571_ERROR_IO);
  EXPECT_NE(text.find("timer"), std::string::npos) << text;
  EXPECT_NE(text.find("directory"), std::string::npos) << text;
}

TEST_F(IioLocal, TheSampleRateIsWrittenWhereItLives) {
  bed_->add_device(labelled_adc());
  IioSourceOptions o;
  o.sample_rate_hz = 12345.5;
  {
    const auto source = open_iio_source(o);
    EXPECT_EQ(source->info().sample_rate_hz, 12345.5);
    EXPECT_EQ(bed_->read("sampling_frequency"), "12345.5");
  }
  EXPECT_EQ(bed_->read("sampling_frequency"), "1000") << "nobody has read the device";
  {
    const auto source = open_iio_source(o);
    source->start();
    source->stop();
  }
  EXPECT_EQ(bed_->read("sampling_frequency"), "12345.5") << "somebody has";
}

TEST_F(IioLocal, MissingPermissionIsNamedWithTheRemedy) {
  if (geteuid() == 0)
    GTEST_SKIP() << "root may do everything";
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  std::filesystem::permissions(bed_->node(), std::filesystem::perms::none);
  std::string text;
  EXPECT_EQ(status_of([&] { source->start(); }, &text), ADA4571_ERROR_PERMISSION);
  EXPECT_NE(text.find("udev rules"), std::string::npos) << text;
}

TEST_F(IioLocal, ABufferThatCannotBeMadeIsReportedAndCanBeTriedAgain) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  std::filesystem::rename(bed_->node(), bed_->root() / "dev/away");
  std::string text;
  EXPECT_EQ(status_of([&] { source->start(); }, &text), ADA4571_ERROR_NOT_FOUND) << text;
  EXPECT_NE(text.find("iio:device0"), std::string::npos) << text;
  std::filesystem::rename(bed_->root() / "dev/away", bed_->node());
  EXPECT_EQ(status_of([&] { source->start(); }, &text), ADA4571_OK) << text;
}

TEST_F(IioLocal, AMachineWithoutIioHasNoDevicesAndSaysSo) {
  std::filesystem::remove_all(bed_->root() / "sys/bus/iio");
  EXPECT_TRUE(list_iio_devices("local:").empty());
  std::string text;
  EXPECT_EQ(status_of([&] { open_iio_source({}); }, &text), ADA4571_ERROR_NOT_FOUND);
  EXPECT_NE(text.find("no IIO device"), std::string::npos) << text;
}

TEST_F(IioLocal, HwmonDevicesInTheSameContextAreNoConverters) {
  const auto hwmon = bed_->root() / "sys/class/hwmon/hwmon0";
  std::filesystem::create_directories(hwmon);
  std::ofstream(hwmon / "name") << "fake-adc\n"; // of the same name, to be mistaken for it
  for (const char *input : {"in0_input", "in1_input", "in0_label", "in1_label"})
    std::ofstream(hwmon / input) << "1\n";
  bed_->add_device(labelled_adc());
  const auto list = list_iio_devices("local:");
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].device.id, "iio:device0");
  IioSourceOptions o;
  o.device = "fake-adc";
  EXPECT_EQ(open_iio_source(o)->info().description, "local: fake-adc (iio:device0)");
}

TEST_F(IioLocal, DriverCalibrationIsReadAndWrittenWhereItExists) {
  BedDevice device = labelled_adc();
  for (int i = 0; i < 2; ++i) {
    device.channels[static_cast<std::size_t>(i)].attributes["calibbias"] = "0";
    device.channels[static_cast<std::size_t>(i)].attributes["calibscale"] = "1.000000";
  }
  bed_->add_device(device);
  const auto source = open_iio_source({});
  DriverCalibration c = source->read_driver_calibration();
  EXPECT_EQ(c.sin.bias, 0.0);
  EXPECT_EQ(c.cos.scale, 1.0);
  EXPECT_DOUBLE_EQ(c.sin.volts_per_count, 1e-4);
  c.sin.bias = -123;
  c.cos.scale = 1.0125;
  source->write_driver_calibration(c);
  EXPECT_EQ(bed_->read("in_voltage0_calibbias"), "-123");
  EXPECT_EQ(bed_->read("in_voltage1_calibscale"), "1.0125");
}

TEST_F(IioLocal, ADriverWithoutCalibrationSaysSo) {
  bed_->add_device(labelled_adc());
  const auto source = open_iio_source({});
  EXPECT_EQ(status_of([&] { source->read_driver_calibration(); }), ADA4571_ERROR_NOT_FOUND);
  DriverCalibration c;
  c.sin.bias = 1.0;
  EXPECT_EQ(status_of([&] { source->write_driver_calibration(c); }), ADA4571_ERROR_UNSUPPORTED);
  EXPECT_FALSE(std::filesystem::exists(bed_->sysfs() / "in_voltage0_calibbias")); // not made either
}

TEST_F(IioLocal, ARefusedCalibrationLeavesTheOldValues) {
  BedDevice device = labelled_adc();
  device.channels[0].attributes["calibbias"] = "11";
  device.channels[1].attributes["calibbias"] = "22";
  bed_->add_device(device);
  const auto source = open_iio_source({});
  // The second write fails: its file has become a folder.
  std::filesystem::remove(bed_->sysfs() / "in_voltage1_calibbias");
  std::filesystem::create_directory(bed_->sysfs() / "in_voltage1_calibbias");
  DriverCalibration c;
  c.sin.bias = 5.0;
  c.cos.bias = 6.0;
  EXPECT_NE(status_of([&] { source->write_driver_calibration(c); }), ADA4571_OK);
  EXPECT_EQ(bed_->read("in_voltage0_calibbias"), "11");
}

TEST_F(IioLocal, WhatWasFoundCanBeStored) {
  BedDevice device = labelled_adc();
  device.attributes["label"] = "shaft";
  bed_->add_device(device);
  const auto source = open_iio_source({});
  const IioSourceOptions o = source->resolved_options();
  EXPECT_EQ(o.device, "shaft");
  EXPECT_EQ(o.channels.sin, "vsin");
  EXPECT_EQ(o.channels.temp, "vtemp");
  EXPECT_EQ(o.channels.vdd, "");
  EXPECT_EQ(open_iio_source(o)->info().description, source->info().description);
}

} // namespace
