// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Live frames, and live angles from them.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/handles.h"
#include "common/source_options.h"
#include "common/stop.h"

namespace cli {

/// What came, and what did not.
struct Losses {
  std::uint64_t frames = 0;
  std::uint64_t bad_times = 0; ///< frames whose timestamp made no sense
  std::uint64_t samples = 0;   ///< lost, counted from the timestamps
  std::uint64_t places = 0;
  std::uint64_t returns = 0; ///< of a device or server that was away
  std::uint64_t missed = 0;  ///< meanwhile, by the sample rate; 0 where that is unknown
};

/// Frames of a device that stay as it gave them.
struct DeviceBlock {
  std::size_t count = 0;
  double first_s = 0, last_s = 0; ///< shifted as the times of frames are
  double shift_s = 0;
};

/// Reads a source block after block. While it lives, signals end the reading and nothing else: work
/// that must be finished afterwards is finished before it goes.
class LiveReader {
public:
  /// `reconnect`: when device or server are lost, tries once a second until they are back.
  /// `patience`: how long nothing may come.
  LiveReader(const Source &source, bool reconnect,
             std::chrono::seconds patience = std::chrono::seconds(10));

  /// Starts the source and hands over block after block, until `take` returns false, the source is
  /// exhausted, or Ctrl-C. `take` is also called with an empty block a few times a second when
  /// nothing comes. Throws when nothing comes for too long and when the source is lost, unless
  /// it reconnects. Times go on through an absence.
  void run(const std::function<bool(std::span<const ada4571_frame>)> &take);
  /// The same without a sample converted.
  void run_blocks(const std::function<bool(const DeviceBlock &)> &take);

  /// Between the loss of the source and the first frame after its return.
  bool away() const { return away_; }
  /// The source has no more: a recording, or one that a server plays, is over.
  bool ended() const { return ended_; }
  Losses losses() const;
  /// Standard error: what was lost, when anything was.
  void report() const;

private:
  using Clock = std::chrono::steady_clock;
  /// What was read, without the shift of its times.
  struct Came {
    std::size_t count = 0;
    double first_s = 0, last_s = 0;
  };
  /// Status, what came and how it ended.
  using Read = std::function<ada4571_status(Came &, ada4571_read_outcome &)>;
  /// Takes what was read last, false when it is enough; count 0: nothing came.
  using Hand = std::function<bool(std::size_t count)>;

  void loop(const Read &read, const Hand &hand);
  void greet_return(double first_s);
  bool hand_over(const Came &came, const Hand &hand);
  bool wait_for_return(const std::string &why, const Hand &hand);
  void end_connection();

  const Source &source_;
  bool reconnect_;
  std::chrono::seconds patience_;
  Losses before_;            ///< of the connections that ended
  bool counted_ = true;      ///< before_ holds the newest connection too
  Clock::time_point last_{}; ///< when something came
  double shift_s_ = 0;       ///< that makes the times of this connection go on
  double last_s_ = 0;        ///< time of the last frame, shifted
  bool away_ = false;
  bool any_ = false; ///< a frame has come
  bool ended_ = false;
  StopSignal stop_; ///< last: it ends before what it touches
};

/// A device that gives nothing for long is not set up; a capture may have a gap of any length.
std::chrono::seconds patience(const SourceOptions &source);

/// The flag of the verbs that read live.
void add_reconnect_option(CLI::App &verb, bool &reconnect);

/// A source and the calibration of its frames, at its supply.
struct Live {
  Source source;
  Model model;
};

/// The options of the source, of a capture in its place and of the calibration.
void add_live_options(CLI::App &verb, SourceOptions &source, std::string &calibration);

/// Opens the source. Its calibration: the file when one is named, which then also says the supply
/// and the periods a turn where the options do not; else what the stored configuration or the
/// driver has; else an ideal sensor, which standard error is told.
Live open_live(const SourceOptions &options, const std::string &calibration);

/// Frames to angles, block after block: a converter, or with `dynamic` a tracker.
class LiveAngles {
public:
  LiveAngles(const Model &model, bool dynamic);
  std::span<const ada4571_angle> convert(std::span<const ada4571_frame> frames);
  /// 360/p degrees.
  double range_deg() const { return range_deg_; }

private:
  Converter converter_;
  Tracker tracker_;
  double range_deg_;
  std::vector<ada4571_angle> angles_;
};

/// 360/p degrees of a model.
double angle_range_deg(const Model &model);

/// Tells standard error what of the angle's correction has no name.
void mention_remainder(const Model &model);

} // namespace cli
