// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The simulated sensor, or a recording, as a network IIO device for any libiio client.
#pragma once

#include <memory>

#include "recording/capture.h"
#include "simulation/iiod_server.h"
#include "simulation/simulation.h"

namespace ada {

/// The device "ada4571-sim" with voltage0 to voltage3 labelled vsin, vcos, vtemp, vdd (as far as
/// the simulation has them) and timestamp. Each buffer begins the simulation anew, but for one
/// that takes the place of one that timed out. VDD is measured through a divider of one half, since
/// it may exceed the converter's reference.
std::shared_ptr<ServedContext> emulated_context(std::shared_ptr<const Simulation> simulation);

/// The device "ada4571-replay", which gives the capture `speed` times as fast as it was recorded; its
/// timestamps are those of a device that is so fast. A channel whose volts are codes of the
/// converter that the capture names has that converter's bits, any other 32. The reference is left out.
std::shared_ptr<ServedContext> replayed_context(std::shared_ptr<const Capture> capture,
                                                double speed);

class Emulator {
public:
  Emulator(std::shared_ptr<ServedContext> context, int port) : server_(std::move(context), port) {}

  int port() const { return server_.port(); }
  void run() { server_.run(); }
  void stop() noexcept { server_.stop(); }

private:
  IiodServer server_;
};

} // namespace ada
