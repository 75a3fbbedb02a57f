// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The simulated sensor as a source like any other.
#pragma once

#include <memory>

#include "acquisition/pace.h"
#include "acquisition/source.h"
#include "simulation/generator.h"

namespace ada {

class SimulatedSource final : public Source {
public:
  SimulatedSource(const Simulation &simulation, bool realtime);

  const SourceInfo &info() const override { return info_; }
  void start() override;
  ReadResult read(std::span<Frame> out, std::chrono::milliseconds timeout) override;
  int poll_fd() override { return pace_.fd(); }
  void cancel() noexcept override { pace_.cancel(); }
  void stop() noexcept override;
  SourceStatistics statistics() const override { return statistics_; }

private:
  /// A frame is there at the end of its period.
  double due_s(std::uint64_t frame) const {
    return static_cast<double>(frame + 1) / info_.sample_rate_hz;
  }
  void refill();

  Simulation simulation_;
  SourceInfo info_;
  SourceStatistics statistics_;
  std::unique_ptr<Generator> generator_;
  Capture chunk_;
  std::size_t next_in_chunk_ = 0, generated_ = 0, total_ = 0;
  Pace pace_;
};

} // namespace ada
