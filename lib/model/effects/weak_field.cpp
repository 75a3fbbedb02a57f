// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The magnet does not saturate the stripes. Each stripe with easy axis theta balances
// sin(alpha - phi) = (h/2) sin 2(phi - theta), h = Hk/H, and its resistance goes with
// cos 2(phi - theta). The cosine bridge has stripes at 0 and 90 degrees, the sine bridge at 45 and
// 135. To leading order c = A[(1 - q) cos psi + q cos 3psi], s = A[(1 - q) sin psi - q sin 3psi],
// with q = 3 h^2/8. The balance is solved exactly for AMR parts (p = 2); other parts use the
// leading term.

#include "model/effects/common.h"
#include "model/stripe_balance.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"q", "1", 0.01, 0.0, 0.09, Role::fitted, 1e-4}};

constexpr std::array<Separation, 2> kSeparations{
    {{"cubic-nonlinearity",
      "change the air gap (the field) or the amplitude (the gain control) and capture again"},
     {"harmonic-distortion",
      "change the air gap and capture again: q falls with the square of the field"}}};

constexpr EffectInfo kInfo{.id = "weak-field",
                           .cause = "The magnet is too weak or too far away to saturate the "
                                    "stripes, which adds a third harmonic.",
                           .stage = Stage::bridge,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations};

class WeakField final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double q = v[0];
    if (q == 0.0)
      return;
    // Below zero there is no such physics; a fit that wanders there sees the leading term go on.
    if (w.periods == 2 && q > 0.0)
      unsaturated(std::sqrt(8.0 * q / 3.0), w);
    else
      leading_term(q, w);
  }

private:
  static void leading_term(double q, Wave &w) {
    for (std::size_t i = 0; i < w.n; ++i) {
      const double x = w.ex[i], y = w.ey[i];
      const double c3 = x * (4.0 * x * x - 3.0), s3 = y * (3.0 - 4.0 * y * y);
      w.c[i] += q * (c3 - x);
      w.s[i] -= q * (s3 + y);
    }
  }
  /// A stray or displaced field also has another magnitude.
  static void unsaturated(double h, Wave &w) {
    double c[kWaveBlock], s[kWaveBlock];
    balance_stripes(h, w.fx, w.fy, w.ex, w.ey, w.n, c, s);
    for (std::size_t i = 0; i < w.n; ++i) {
      w.c[i] += c[i] - w.ex[i];
      w.s[i] += s[i] - w.ey[i];
    }
  }
};

} // namespace

const Effect &weak_field() {
  static const WeakField effect;
  return effect;
}

} // namespace ada
