// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The magnet does not saturate the stripes. Each stripe with easy axis theta balances
// sin(alpha - phi) = (h/2) sin 2(phi - theta), h = Hk/H, and its resistance goes with
// cos 2(phi - theta). The cosine bridge has stripes at 0 and 90 degrees, the sine bridge at 45 and
// 135. To leading order c = A[(1 - q) cos psi + q cos 3psi], s = A[(1 - q) sin psi - q sin 3psi],
// with q = 3 h^2/8. The balance is solved exactly for AMR parts (p = 2); other parts use the
// leading term.
// Where the bridges are turned against each other by what the pair lacks of a quarter of a period,
// each balances in a field that is turned for it, and the third harmonic is shifted by three times
// as much; channels that mix behind their bridges share one that is not.

#include "model/effects/common.h"
#include "model/stripe_balance.h"

namespace ada {
namespace {

/// `turned`: the part of the quadrature error by which the bridges are turned; absent: none of it,
/// the two channels mix.
constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"q", "1", 0.01, 0.0, 0.09, Role::fitted, 1e-4},
    ParameterInfo{"turned", "1", std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0, Role::chosen}};

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
    double c[kWaveBlock], s[kWaveBlock];
    const double apart = v[1] > 0.0 ? v[1] * w.apart_rad : 0.0;
    if (apart == 0.0) {
      outputs(q, w, w.ex, w.ey, c, s);
    } else {
      // What each bridge gives, before the mixture that the quadrature error is afterwards.
      const double ch = std::cos(0.5 * apart), sh = std::sin(0.5 * apart);
      double x[kWaveBlock], y[kWaveBlock], unused[kWaveBlock];
      const auto turn = [&](double sine) {
        for (std::size_t i = 0; i < w.n; ++i) {
          x[i] = w.ex[i] * ch - w.ey[i] * sine;
          y[i] = w.ey[i] * ch + w.ex[i] * sine;
        }
      };
      turn(sh);
      outputs(q, w, x, y, unused, s);
      turn(-sh);
      outputs(q, w, x, y, c, unused);
      const double determinant = ch * ch - sh * sh;
      for (std::size_t i = 0; i < w.n; ++i) {
        const double of_s = s[i], of_c = c[i];
        s[i] = (ch * of_s - sh * of_c) / determinant;
        c[i] = (ch * of_c - sh * of_s) / determinant;
      }
    }
    for (std::size_t i = 0; i < w.n; ++i) {
      w.c[i] += c[i] - w.ex[i];
      w.s[i] += s[i] - w.ey[i];
    }
  }
  std::vector<std::vector<double>> choices(Values v) const override {
    return {{v[0], v[1] > 0.0 ? std::nan("") : 1.0}};
  }

private:
  /// Of both bridges in a field of this electrical direction. Below zero there is no such physics;
  /// a fit that wanders there sees the leading term go on.
  static void outputs(double q, const Wave &w, const double *ex, const double *ey, double *c,
                      double *s) {
    if (w.periods == 2 && q > 0.0) // a stray or displaced field also has another magnitude
      balance_stripes(std::sqrt(8.0 * q / 3.0), w.fx, w.fy, ex, ey, w.n, c, s);
    else
      for (std::size_t i = 0; i < w.n; ++i) {
        const double x = ex[i], y = ey[i];
        const double c3 = x * (4.0 * x * x - 3.0), s3 = y * (3.0 - 4.0 * y * y);
        c[i] = x + q * (c3 - x);
        s[i] = y - q * (s3 + y);
      }
  }
};

} // namespace

const Effect &weak_field() {
  static const WeakField effect;
  return effect;
}

} // namespace ada
