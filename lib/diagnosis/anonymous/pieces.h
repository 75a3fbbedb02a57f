// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The terms of a generic basis taken apart into exponentials of the angle, each times at most one
// function of the conditions: the product of two of them is one again.
#pragma once

#include <complex>
#include <vector>

#include "diagnosis/anonymous/basis.h"

namespace ada {

struct Pieces {
  explicit Pieces(const Basis &basis);

  /// factor times function (-1: none) times e^(j exponent x).
  struct Piece {
    int exponent;
    std::complex<double> factor;
    int function;
  };
  int unit;                                ///< of all exponents
  std::vector<std::vector<Piece>> of_term; ///< of each term
  std::vector<Modulation> functions;
  std::vector<int> exponents; ///< of the terms with a function, in their order
  int highest_plain = 0, highest_mixed = 0;

private:
  void take_apart(const Basis &basis);
};

} // namespace ada
