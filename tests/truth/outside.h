// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// Benches whose sensors and drives are no entry of the catalogue: what people bring. Each has a
/// mismatch and a quadrature error as an ellipse fit would find them, and something else on top.

#pragma once

#include "conditions.h"
#include "finding.h"
#include <string>
#include <vector>

namespace truth {

const std::vector<std::string> &outside_kinds();

/// Draws a whole capture, and what is right to say of it.
Conditions draw_outside(const std::string &kind, Random &random, Expectation &expectation);

} // namespace truth
