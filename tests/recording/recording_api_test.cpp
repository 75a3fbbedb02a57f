// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "ada4571.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class RecordingApi : public testing::Test {
protected:
  void SetUp() override { ada4571_recording_info_init(&info_); }

  /// Writes `frames` frames with VTEMP and leaves the writer open.
  ada4571_writer *open_with(int frames) {
    info_.has_vtemp = 1;
    info_.serial = "S1";
    info_.sample_rate_hz = 1000;
    ada4571_writer *writer = nullptr;
    EXPECT_EQ(ada4571_writer_open(path_.c_str(), &info_, &writer), ADA4571_OK)
        << ada4571_last_error();
    EXPECT_EQ(ada4571_writer_metadata(writer, "bench", "3"), ADA4571_OK);
    for (int i = 0; i < frames; ++i) {
      const ada4571_frame frame{i * 1e-3, 1.0 + i, 2.0 + i, 1.5, kNan, kNan};
      EXPECT_EQ(ada4571_writer_write(writer, &frame, 1), ADA4571_OK) << ada4571_last_error();
    }
    return writer;
  }

  TempFolder folder_;
  std::string path_ = folder_ / "c.csv";
  ada4571_recording_info info_;
};

TEST_F(RecordingApi, WritesReadsAndSaves) {
  ada4571_writer *writer = open_with(10);
  ASSERT_EQ(ada4571_writer_finish(writer), ADA4571_OK) << ada4571_last_error();
  ada4571_writer_free(writer);

  ada4571_recording *recording = nullptr;
  ASSERT_EQ(ada4571_recording_open(path_.c_str(), &recording), ADA4571_OK);
  ASSERT_EQ(ada4571_recording_save(recording, (folder_ / "d.sigmf-meta").c_str()), ADA4571_OK);
  ada4571_recording_free(recording);
  ASSERT_EQ(ada4571_recording_open((folder_ / "d.sigmf-data").c_str(), &recording), ADA4571_OK);

  ada4571_recording_info info;
  ada4571_recording_info_init(&info);
  ASSERT_EQ(ada4571_recording_get_info(recording, &info), ADA4571_OK);
  EXPECT_EQ(info.samples, 10u);
  EXPECT_DOUBLE_EQ(info.duration_s, 9e-3);
  EXPECT_EQ(info.has_vtemp, 1);
  EXPECT_EQ(info.has_vdd, 0);
  EXPECT_EQ(info.has_reference, 0);
  EXPECT_EQ(info.gain_control, -1);
  EXPECT_TRUE(std::isnan(info.noise_rms_v));
  EXPECT_EQ(info.sample_rate_hz, 1000);
  EXPECT_STREQ(info.serial, "S1");
  EXPECT_STREQ(info.origin, "");
  EXPECT_STREQ(ada4571_recording_metadata(recording, "bench"), "3");
  EXPECT_STREQ(ada4571_recording_metadata(recording, "supply_v"), "5");
  EXPECT_EQ(ada4571_recording_metadata(recording, "noise_rms_v"), nullptr);
  EXPECT_EQ(ada4571_recording_metadata(recording, "nothing"), nullptr);

  ada4571_frame frames[4];
  std::size_t count = 99;
  ASSERT_EQ(ada4571_recording_read(recording, 8, frames, 4, &count), ADA4571_OK);
  ASSERT_EQ(count, 2u);
  EXPECT_EQ(frames[1].vsin_v, 10.0);
  EXPECT_EQ(frames[1].vtemp_v, 1.5);
  EXPECT_TRUE(std::isnan(frames[1].vdd_v));
  ASSERT_EQ(ada4571_recording_read(recording, 10, nullptr, 0, &count), ADA4571_OK);
  EXPECT_EQ(count, 0u);
  ASSERT_EQ(ada4571_recording_read(recording, static_cast<std::size_t>(-1), frames, 4, &count),
            ADA4571_OK);
  EXPECT_EQ(count, 0u);
  ada4571_recording_free(recording);
}

TEST_F(RecordingApi, AFailedWriteNeverBecomesAFile) {
  ada4571_writer *writer = open_with(3);
  const ada4571_frame bad{1, kNan, 2, 1.5, kNan, kNan};
  EXPECT_EQ(ada4571_writer_write(writer, &bad, 1), ADA4571_ERROR_INVALID_ARGUMENT);
  EXPECT_STREQ(ada4571_last_error(), "frame 3: vsin_v is not a number");
  EXPECT_EQ(ada4571_writer_finish(writer), ADA4571_ERROR_STATE);
  ada4571_writer_free(writer);
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(RecordingApi, AFinishedWriterTakesNoMore) {
  ada4571_writer *writer = open_with(3);
  ASSERT_EQ(ada4571_writer_finish(writer), ADA4571_OK);
  const ada4571_frame frame{1, 1, 2, 1.5, kNan, kNan};
  EXPECT_EQ(ada4571_writer_write(writer, &frame, 1), ADA4571_ERROR_STATE);
  EXPECT_EQ(ada4571_writer_metadata(writer, "a", "b"), ADA4571_ERROR_STATE);
  EXPECT_EQ(ada4571_writer_finish(writer), ADA4571_ERROR_STATE);
  ada4571_writer_free(writer);
  EXPECT_EQ(folder_.names().size(), 1u);
}

TEST_F(RecordingApi, LeavesResultsUntouchedOnFailure) {
  auto *recording = reinterpret_cast<ada4571_recording *>(&info_);
  EXPECT_EQ(ada4571_recording_open((folder_ / "no.csv").c_str(), &recording),
            ADA4571_ERROR_NOT_FOUND);
  EXPECT_EQ(recording, reinterpret_cast<ada4571_recording *>(&info_));
}

TEST_F(RecordingApi, NullIsAStatus) {
  ada4571_writer *writer = open_with(1);
  ASSERT_EQ(ada4571_writer_finish(writer), ADA4571_OK);
  ada4571_writer_free(writer);
  ada4571_recording *recording = nullptr;
  ASSERT_EQ(ada4571_recording_open(path_.c_str(), &recording), ADA4571_OK);
  ada4571_frame frame;
  std::size_t count;
  constexpr auto kInvalid = ADA4571_ERROR_INVALID_ARGUMENT;

  ada4571_recording_info_init(nullptr);
  EXPECT_EQ(ada4571_recording_open(nullptr, &recording), kInvalid);
  EXPECT_EQ(ada4571_recording_open(path_.c_str(), nullptr), kInvalid);
  EXPECT_EQ(ada4571_recording_get_info(nullptr, &info_), kInvalid);
  EXPECT_EQ(ada4571_recording_get_info(recording, nullptr), kInvalid);
  EXPECT_EQ(ada4571_recording_metadata(nullptr, "a"), nullptr);
  EXPECT_EQ(ada4571_recording_metadata(recording, nullptr), nullptr);
  EXPECT_EQ(ada4571_recording_read(nullptr, 0, &frame, 1, &count), kInvalid);
  EXPECT_EQ(ada4571_recording_read(recording, 0, nullptr, 1, &count), kInvalid);
  EXPECT_EQ(ada4571_recording_read(recording, 0, &frame, 1, nullptr), kInvalid);
  EXPECT_EQ(ada4571_recording_save(nullptr, path_.c_str()), kInvalid);
  EXPECT_EQ(ada4571_recording_save(recording, nullptr), kInvalid);
  EXPECT_EQ(ada4571_writer_open(nullptr, &info_, &writer), kInvalid);
  EXPECT_EQ(ada4571_writer_open(path_.c_str(), nullptr, &writer), kInvalid);
  EXPECT_EQ(ada4571_writer_open(path_.c_str(), &info_, nullptr), kInvalid);
  EXPECT_EQ(ada4571_writer_metadata(nullptr, "a", "b"), kInvalid);
  EXPECT_EQ(ada4571_writer_write(nullptr, &frame, 1), kInvalid);
  EXPECT_EQ(ada4571_writer_finish(nullptr), kInvalid);
  ada4571_writer_free(nullptr);
  ada4571_recording_free(nullptr);
  info_.struct_size = 1;
  EXPECT_EQ(ada4571_recording_get_info(recording, &info_), kInvalid);
  ada4571_recording_free(recording);
}

} // namespace
} // namespace ada::test
