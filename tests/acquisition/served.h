// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A server of IIO devices of any kind in this process, with faults on demand.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "simulation/iiod_server.h"

namespace ada::test {

/// Counts by a function of frame and column.
class CountTable final : public FrameCounts {
public:
  using Value = std::function<std::int64_t(std::size_t frame, std::size_t column)>;
  CountTable(std::size_t columns, Value value, std::size_t end = ~std::size_t{0})
      : columns_(columns), value_(std::move(value)), end_(end) {}

  std::size_t next(std::span<std::int64_t> counts, std::size_t frames) override {
    std::size_t done = 0;
    for (; done < frames && frame_ < end_; ++done, ++frame_)
      for (std::size_t c = 0; c < columns_; ++c)
        counts[done * columns_ + c] = value_(frame_, c);
    return done;
  }

private:
  std::size_t columns_;
  Value value_;
  std::size_t end_, frame_ = 0;
};

class Served {
public:
  explicit Served(std::shared_ptr<ServedContext> context, IiodServer::FaultHook faults = {},
                  int port = 0)
      : server_(std::make_unique<IiodServer>(std::move(context), port, std::move(faults))),
        port_(server_->port()), thread_([this] { server_->run(); }) {}
  ~Served() { die(); }

  int port() const { return port_; }
  std::string uri() const { return "ip:127.0.0.1:" + std::to_string(port_); }
  /// The server ends and closes every connection.
  void die() {
    if (!thread_.joinable())
      return;
    server_->stop();
    thread_.join();
    server_.reset();
  }

private:
  std::unique_ptr<IiodServer> server_;
  int port_;
  std::thread thread_;
};

/// A labelled pair in the given formats, with or without timestamp; frame n gives counts n + 1 on
/// the first channel and 3 n on the second, as far as the bits go.
inline std::shared_ptr<ServedContext> served_pair(ScanFormat sin, ScanFormat cos, double rate_hz,
                                                  bool timestamp = true,
                                                  std::size_t end = ~std::size_t{0}) {
  auto context = std::make_shared<ServedContext>();
  ServedDevice device{"iio:device0", "served-adc", "", {}, {}, rate_hz, {}, {}};
  const ScanFormat formats[] = {sin, cos};
  const char *labels[] = {"vsin", "vcos"};
  for (int i = 0; i < 2; ++i)
    device.channels.push_back({"voltage" + std::to_string(i),
                               i,
                               formats[i],
                               1.0,
                               {{"label", labels[i], {}, {}}, {"scale", "1", {}, {}}}});
  if (timestamp) {
    ScanFormat stamp;
    stamp.bits = stamp.storage = 64;
    stamp.is_signed = true;
    device.channels.push_back({"timestamp", 2, stamp, std::nullopt, {}});
  }
  if (rate_hz > 0.0)
    device.attributes = {{"sampling_frequency", std::to_string(rate_hz), {}, {}}};
  device.frames = [end] {
    return std::make_unique<CountTable>(
        2,
        [](std::size_t n, std::size_t c) {
          return static_cast<std::int64_t>(c == 0 ? n + 1 : 3 * n);
        },
        end);
  };
  context->devices.push_back(std::move(device));
  return context;
}

} // namespace ada::test
