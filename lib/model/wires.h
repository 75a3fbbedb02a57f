// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the wires of the record do: exchanged and inverted channels.
#pragma once

#include <array>

#include "model/model.h"

namespace ada {

/// What the wires make of a volt in one channel, off mid-supply: rows are VSIN and VCOS as
/// recorded.
struct Wires {
  double sin_of_sin = 1.0, sin_of_cos = 0.0, cos_of_sin = 0.0, cos_of_cos = 1.0;
  bool plain() const { return sin_of_sin == 1.0 && cos_of_cos == 1.0; }
};

Wires wires_of(const Model &model);

/// Centre of the pair as it is recorded, V: (VSIN, VCOS).
std::array<double, 2> recorded_centre_v(const Model &model);

} // namespace ada
