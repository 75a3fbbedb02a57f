// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/pieces.h"

#include <algorithm>

namespace ada {

Pieces::Pieces(const Basis &basis) : unit(basis.unit()) {
  take_apart(basis);
  std::sort(exponents.begin(), exponents.end());
  exponents.erase(std::unique(exponents.begin(), exponents.end()), exponents.end());
}

void Pieces::take_apart(const Basis &basis) {
  for (Basis::Term t : basis.terms()) {
    t.exponent /= unit;
    Modulation by = t.modulation;
    if (by.of_angle())
      by.order /= unit;
    const std::complex<double> half_j(0.0, 0.5);
    if (by.kind == Modulation::angle_cos)
      of_term.push_back({{t.exponent + by.order, 0.5, -1}, {t.exponent - by.order, 0.5, -1}});
    else if (by.kind == Modulation::angle_sin)
      of_term.push_back(
          {{t.exponent + by.order, -half_j, -1}, {t.exponent - by.order, half_j, -1}});
    else if (by.kind == Modulation::none)
      of_term.push_back({{t.exponent, 1.0, -1}});
    else {
      auto at = std::find(functions.begin(), functions.end(), by);
      if (at == functions.end())
        at = functions.insert(functions.end(), by);
      of_term.push_back({{t.exponent, 1.0, static_cast<int>(at - functions.begin())}});
      highest_mixed = std::max(highest_mixed, std::abs(t.exponent));
      exponents.push_back(t.exponent);
    }
    for (const Piece &p : of_term.back())
      if (p.function < 0)
        highest_plain = std::max(highest_plain, std::abs(p.exponent));
  }
}

} // namespace ada
