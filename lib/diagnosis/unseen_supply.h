// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A supply that nobody recorded, seen through the radius of the pair.
#pragma once

#include <optional>

#include "recording/capture.h"

namespace ada {

/// Both outputs follow the supply about zero volts, not about their middle, so a moving supply
/// moves the radius by an amount that depends on the angle in one known way. Where that explains
/// what the radius does, and a moving gain or offset does not, gives the capture with the VDD
/// column that it must have had. Only for captures without reference and VDD: with a reference the
/// pair itself tells.
std::optional<Capture> with_unseen_supply(const Capture &capture);

} // namespace ada
