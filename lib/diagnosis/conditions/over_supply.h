// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The pair as it would be at one supply, where the supply is recorded and the outputs follow it.
#pragma once

#include <optional>
#include <vector>

#include "recording/capture.h"

namespace ada {

struct PairOfChannels {
  std::vector<double> sin_v, cos_v;
};

/// Spread about the curve with the supply divided out, over that without, below which the outputs
/// follow the supply: a tenth is more than chance does to a spread.
inline constexpr double kFollowsSupply = 0.9;

/// Both outputs times the mean supply over the supply of the moment; nothing without VDD, or where
/// it is steady. A reading of the supply below half of its mean is no supply and changes nothing.
std::optional<PairOfChannels> over_supply(const Capture &capture);

} // namespace ada
