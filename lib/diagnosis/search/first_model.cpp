// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/first_model.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/search/fit.h"
#include "diagnosis/search/search.h"

namespace ada {

double expected_noise(const Capture &capture, const Scene &scene, bool &stated) {
  stated = capture.meta.noise_rms_v.has_value();
  if (!stated)
    return scene.white_noise_v;
  double variance = *capture.meta.noise_rms_v * *capture.meta.noise_rms_v;
  if (capture.meta.adc_bits && capture.meta.adc_reference_v) {
    const double lsb = *capture.meta.adc_reference_v / std::exp2(*capture.meta.adc_bits);
    variance += lsb * lsb / 12.0;
  }
  return std::max(std::sqrt(variance), 1e-9);
}

Model first_model(const Scene &scene, const Model *given) {
  Model model;
  if (given) {
    model = given->at_supply(scene.supply_v);
    model.baseline_std_error = {0, 0, 0, 0};
  }
  model.periods_per_turn = scene.periods;
  model.supply_v = scene.supply_v;
  if (!given)
    model.vtemp_reference_v = scene.vtemp_mean_v;
  bool turned = false;
  for (const EffectInstance &e : model.effects)
    turned = turned || e.effect->info().evidence == Evidence::screening;
  // Wiring is settled before any fit; a screened effect without action on the pair does nothing.
  for (const ScreenFinding &f : scene.screened)
    if (f.effect->info().correctable && f.effect->info().evidence == Evidence::screening && !turned)
      model.effects.insert(model.effects.begin(), {f.effect, f.values, f.std_errors});

  const auto span_of = [](const std::vector<float> &v) {
    return std::pair(quantile(v, 0.005), quantile(v, 0.995));
  };
  const auto [slow, shigh] = span_of(scene.all.vsin);
  const auto [clow, chigh] = span_of(scene.all.vcos);
  Baseline &b = model.baseline;
  if (!given) {
    b.amplitude_v = 0.25 * (shigh - slow + chigh - clow);
    b.offset_sin_v = 0.5 * (shigh + slow - scene.supply_v);
    b.offset_cos_v = 0.5 * (chigh + clow - scene.supply_v);
  }
  // The zero angle by the mean turn from the model without it to the data.
  b.angle_zero_deg = 0.0;
  Model plain = model;
  std::erase_if(plain.effects, [](const EffectInstance &e) {
    return e.effect->info().evidence == Evidence::signal;
  });
  const auto some = scene.all.select(thin(scene.train, 5000));
  const ResidualColumns r = residual_columns(some, plain);
  double c = 0.0, s = 0.0;
  const double ms = 0.5 * scene.supply_v + b.offset_sin_v,
               mc = 0.5 * scene.supply_v + b.offset_cos_v;
  for (std::size_t i = 0; i < some.size(); ++i) {
    const double x = r.model_cos[i] - mc, y = r.model_sin[i] - ms;
    const double u = some.vcos[i] - mc, v = some.vsin[i] - ms;
    c += u * x + v * y;
    s += v * x - u * y;
  }
  double turn = std::atan2(s, c);
  for (const EffectInstance &e : plain.effects) // a reversed pair turns the other way
    if (e.effect->info().correctable)
      turn = -turn;
  b.angle_zero_deg = turn * kDegPerRad / scene.periods;
  return model;
}

Model with_expected(Model model) {
  for (const Effect *effect : catalogue())
    if (effect->info().prior_rank == 0 &&
        std::none_of(model.effects.begin(), model.effects.end(),
                     [&](const EffectInstance &e) { return e.effect == effect; }))
      model.effects.push_back(
          {effect, std::vector<double>(effect->info().parameters.size(), 0.0), {}});
  return model;
}

} // namespace ada
