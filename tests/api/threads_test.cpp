// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Different handles in different threads at once; a handle does not depend on another's life; the
// last error is the thread's own.
#include <cmath>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "handles.h"

namespace {

using api::Handles;
using api::make;

std::vector<double> angles_of(std::uint64_t seed) {
  auto options = api::initialised(ada4571_simulation_options_init);
  options.duration_s = 0.5;
  const ada4571_simulation_options *const given = &options;
  auto *simulation = make<ada4571_simulation>(ada4571_simulation_new,
                                              static_cast<ada4571_model *>(nullptr), given, seed);
  auto *recording = make<ada4571_recording>(ada4571_simulation_run, simulation);
  ada4571_simulation_free(simulation);
  auto *model = make<ada4571_model>(ada4571_calibrate_single, recording, ADA4571_CALIBRATE_FIT);
  auto *converter = make<ada4571_converter>(ada4571_converter_new, model);
  ada4571_model_free(model);
  std::vector<ada4571_angle> angles(5000);
  EXPECT_EQ(ada4571_converter_recording(converter, recording, angles.data()), ADA4571_OK);
  ada4571_recording_free(recording);
  ada4571_converter_free(converter);
  std::vector<double> degrees;
  for (const ada4571_angle &a : angles)
    degrees.push_back(a.angle_deg);
  return degrees;
}

TEST(Threads, DoTheSameTogetherAsAlone) {
  constexpr std::size_t threads = 4;
  std::vector<std::vector<double>> alone, together(threads);
  for (std::size_t seed = 0; seed < threads; ++seed)
    alone.push_back(angles_of(seed));
  std::vector<std::thread> running;
  for (std::size_t seed = 0; seed < threads; ++seed)
    running.emplace_back([&together, seed] { together[seed] = angles_of(seed); });
  for (std::thread &thread : running)
    thread.join();
  EXPECT_EQ(together, alone);
  EXPECT_NE(alone[0], alone[1]) << "the seed changes nothing, so the comparison shows nothing";
}

TEST(Threads, EachHasItsOwnLastError) {
  ASSERT_NE(ada4571_model_load("/nowhere/here.toml", nullptr), ADA4571_OK);
  const std::string mine = ada4571_last_error();
  std::string at_first, theirs;
  std::thread([&] {
    at_first = ada4571_last_error();
    ada4571_model *model = nullptr;
    EXPECT_NE(ada4571_model_load("/nowhere/there.toml", &model), ADA4571_OK);
    theirs = ada4571_last_error();
  }).join();
  EXPECT_EQ(at_first, "");
  EXPECT_NE(theirs, mine);
  EXPECT_EQ(ada4571_last_error(), mine);
}

TEST(Threads, CancelFromAnotherThreadEndsAReadThatWaitsForEver) {
  auto options = api::initialised(ada4571_simulation_options_init);
  options.sample_rate_hz = 0.001; // the second sample is a quarter of an hour away
  options.duration_s = 0;
  const ada4571_simulation_options *const given = &options;
  auto *simulation = make<ada4571_simulation>(
      ada4571_simulation_new, static_cast<ada4571_model *>(nullptr), given, std::uint64_t{1});
  auto *source = make<ada4571_source>(ada4571_source_open_simulation, simulation, 1);
  ASSERT_EQ(ada4571_source_start(source), ADA4571_OK);
  ada4571_read_outcome outcome = ADA4571_READ_FRAMES;
  std::thread reader([&] {
    ada4571_frame frames[2];
    std::size_t count = 0;
    while (outcome == ADA4571_READ_FRAMES)
      ASSERT_EQ(ada4571_source_read(source, frames, 2, -1, &count, &outcome), ADA4571_OK);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(ada4571_source_cancel(source), ADA4571_OK);
  reader.join();
  EXPECT_EQ(outcome, ADA4571_READ_CANCELLED);
  ada4571_source_free(source);
  ada4571_simulation_free(simulation);
}

TEST(Threads, EmulatorStopsFromAnotherThread) {
  const Handles handles;
  auto *emulator = make<ada4571_emulator>(ada4571_emulator_new, handles.simulation, 0);
  EXPECT_GT(ada4571_emulator_port(emulator), 0);
  std::thread server([&] { EXPECT_EQ(ada4571_emulator_run(emulator), ADA4571_OK); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ada4571_emulator_stop(emulator);
  server.join();
  ada4571_emulator_free(emulator);
}

} // namespace
