// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The simulated sensor as a source like any other.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>

#include "acquisition/source.h"
#include "simulation/generator.h"

namespace ada {

class SimulatedSource final : public Source {
public:
  SimulatedSource(const Simulation &simulation, bool realtime);

  const SourceInfo &info() const override { return info_; }
  void start() override;
  ReadResult read(std::span<Frame> out, std::chrono::milliseconds timeout) override;
  void cancel() noexcept override;
  void stop() noexcept override { generator_.reset(); }
  SourceStatistics statistics() const override { return statistics_; }

private:
  /// Waits until `due`, or the end of the time-out, or a cancel.
  enum class Wake { due, timeout, cancelled };
  Wake wait_until_due(std::chrono::milliseconds timeout);
  void refill();

  Simulation simulation_;
  bool realtime_;
  SourceInfo info_;
  SourceStatistics statistics_;
  std::unique_ptr<Generator> generator_;
  Capture chunk_;
  std::size_t next_in_chunk_ = 0, generated_ = 0, total_ = 0;
  std::chrono::steady_clock::time_point started_;
  std::mutex mutex_;
  std::condition_variable woken_;
  bool cancelled_ = false;
};

} // namespace ada
