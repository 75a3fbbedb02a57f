// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// With u = VCOS + i VSIN and psi the pair's angle, a tone P exp(i w t) + N exp(-i w t) turns in the
// frame of the vector as P exp(i (w t - psi)), slow where w is near the pair's own, and as
// N exp(-i (w t + psi)), which is fast. The motion takes a part g of what lies along the circle,
// the imaginary part of the slow one: (1 - g/2) P stays at w, and g/2 conj(P) exp(2 i psi) becomes
// a line that turns with the vector alone, at 2 w_e - w.

#include "diagnosis/lines/images.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "diagnosis/criteria.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

using Complex = std::complex<double>;

bool is_tone(const EffectInstance &e) {
  return is_tone(e.effect->info());
}

/// Coefficients of exp(i w t) and exp(-i w t) in a tone, seen from the side from which the vector
/// turns forward.
struct Turning {
  Complex forward, backward;
};

Turning turning_of(const EffectInstance &tone, double sense) {
  const std::vector<double> x = tone.effect->to_coordinates(tone.values);
  const Complex sin(0.5 * x[2], -0.5 * x[1]), cos(0.5 * x[4], -0.5 * x[3]), i(0.0, sense);
  return {cos + i * sin, std::conj(cos) + i * std::conj(sin)};
}

void set_turning(EffectInstance &tone, const Turning &t, double sense) {
  const Complex cos = 0.5 * (t.forward + std::conj(t.backward));
  const Complex sin = (t.forward - std::conj(t.backward)) / Complex(0.0, 2.0 * sense);
  const double x[] = {tone.values[0], -2.0 * sin.imag(), 2.0 * sin.real(), -2.0 * cos.imag(),
                      2.0 * cos.real()};
  tone.values = tone.effect->from_coordinates(tone.values, x);
}

/// Mean of exp(i (2 psi - w t)): 1 in size where twice the pair's own angle keeps step with w.
Complex step_with_pair(const Observations &data, const ResidualColumns &pair, double sense,
                       double w) {
  Complex sum;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double psi = sense * std::atan2(pair.model_sin[i] - data.centre_sin_v,
                                          pair.model_cos[i] - data.centre_cos_v);
    sum += std::polar(1.0, 2.0 * psi - w * data.time[i]);
  }
  return sum / static_cast<double>(data.size());
}

/// Gives to `tone` what `image` says was taken from it; false where that is no image of it.
bool take_back(const Observations &data, const ResidualColumns &pair, EffectInstance &tone,
               const EffectInstance &image) {
  const double w = kTwoPi * (tone.values[0] + image.values[0]);
  for (double sense : {1.0, -1.0}) {
    Turning of_tone = turning_of(tone, sense);
    const Turning of_image = turning_of(image, sense);
    if (std::abs(of_image.backward) > criteria::kNoImage * std::abs(of_image.forward) ||
        std::abs(of_image.forward) > (1.0 + criteria::kNoImage) * std::abs(of_tone.forward))
      continue;
    const Complex step = step_with_pair(data, pair, sense, w);
    const Complex taken = std::conj(of_image.forward) * std::polar(1.0, std::arg(step));
    if (std::abs(step) < 1.0 - criteria::kNoImage ||
        std::abs(std::arg(taken * std::conj(of_tone.forward))) > criteria::kNoImage)
      continue;
    of_tone.forward += taken;
    set_turning(tone, of_tone, sense);
    return true;
  }
  return false;
}

/// Folds one image, if there is one.
bool fold_one(const Observations &data, const ResidualColumns &pair, Model &model) {
  for (EffectInstance &tone : model.effects)
    for (auto image = model.effects.begin(); image != model.effects.end(); ++image)
      if (&*image != &tone && is_tone(tone) && is_tone(*image) &&
          take_back(data, pair, tone, *image)) {
        model.effects.erase(image);
        return true;
      }
  return false;
}

} // namespace

void fold_images(const Observations &data, Model &model) {
  if (std::count_if(model.effects.begin(), model.effects.end(),
                    [](const EffectInstance &e) { return is_tone(e); }) < 2)
    return;
  const ResidualColumns pair = residual_columns(data, model);
  while (fold_one(data, pair, model)) {
  }
}

} // namespace ada
