// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The simulated sensor behind a simulated converter, as a network IIO device for any libiio client.
#pragma once

#include <memory>

#include "simulation/iiod_server.h"
#include "simulation/simulation.h"

namespace ada {

/// The device "ada4571-sim" with voltage0 to voltage3 labelled vsin, vcos, vtemp, vdd (as far as
/// the simulation has them) and timestamp. Each buffer begins the simulation anew. VDD is measured
/// through a divider of one half, since it may exceed the converter's reference.
std::shared_ptr<ServedContext> emulated_context(std::shared_ptr<const Simulation> simulation);

class Emulator {
public:
  Emulator(std::shared_ptr<const Simulation> simulation, int port)
      : server_(emulated_context(std::move(simulation)), port) {}

  int port() const { return server_.port(); }
  void run() { server_.run(); }
  void stop() noexcept { server_.stop(); }

private:
  IiodServer server_;
};

} // namespace ada
