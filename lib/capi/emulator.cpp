// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/emulator.h"

#include "capi/guard.h"
#include "capi/handles.h"

using namespace ada;
using namespace ada::capi;

struct ada4571_emulator {
  Emulator impl;
};

extern "C" {

ada4571_status ada4571_emulator_new(const ada4571_simulation *simulation, int port,
                                    ada4571_emulator **emulator) {
  return guard([&] {
    require(simulation, "simulation");
    require(emulator, "emulator");
    *emulator = new ada4571_emulator{Emulator(emulated_context(simulation->impl), port)};
  });
}

ada4571_status ada4571_emulator_new_replay(const ada4571_recording *recording, double speed,
                                           int port, ada4571_emulator **emulator) {
  return guard([&] {
    require(recording, "recording");
    require(emulator, "emulator");
    *emulator = new ada4571_emulator{
        Emulator(replayed_context(recording->impl->whole(), speed), port)};
  });
}

int ada4571_emulator_port(const ada4571_emulator *emulator) {
  return emulator ? emulator->impl.port() : 0;
}

ada4571_status ada4571_emulator_run(ada4571_emulator *emulator) {
  return guard([&] {
    require(emulator, "emulator");
    emulator->impl.run();
  });
}

void ada4571_emulator_stop(ada4571_emulator *emulator) {
  if (emulator)
    emulator->impl.stop();
}

void ada4571_emulator_free(ada4571_emulator *emulator) {
  delete emulator;
}

} // extern "C"
