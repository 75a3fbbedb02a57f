// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the steps in time that the anonymous part holds are: what of the pair changes there, and
// which causes of the catalogue do that.
#pragma once

#include <complex>
#include <vector>

#include "diagnosis/anonymous/anonymous.h"
#include "model/model.h"

namespace ada {

/// By how much the pair, cos + j sin, changes at a moment, V: its offsets; along (real) and across
/// (imaginary) a vector, amplitude times gain and electrical angle; mismatch (real) and quadrature
/// (imaginary), as what turns the other way.
struct PairStep {
  double moment_s;
  std::complex<double> offset, pair, mismatch;

  double square_v2() const { return std::norm(offset) + std::norm(pair) + std::norm(mismatch); }
};

std::vector<PairStep> steps_of(const Anonymous &unnamed, int periods_per_turn);

/// Causes that are events and of which these steps consist, all but a little, at their moments and
/// with everything fitted at nothing. `model`: names events already, and those stay what they are.
std::vector<EffectInstance> causes_of_steps(const Anonymous &unnamed, const Model &model);

} // namespace ada
