// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>

#include "capi/guard.h"
#include "capi/handles.h"
#include "model/effect.h"
#include "model/effect_text.h"
#include "model/model_file.h"

namespace {

using ada::capi::at;
using ada::capi::guard;
using ada::capi::require;
using ada::capi::require_struct;
using ada::capi::to_parameter;

/// The catalogue's texts are literals in arrays of characters, so the C strings can point at them.
const char *c_string(std::string_view literal) {
  return literal.data();
}

ada4571_effect_info to_info(const ada::EffectInfo &effect) {
  ada4571_effect_info info;
  info.struct_size = sizeof info;
  info.id = c_string(effect.id);
  info.cause = c_string(effect.cause);
  info.stage = c_string(ada::stage_name(effect.stage));
  info.correctable = effect.correctable;
  info.parameters = effect.parameters.size();
  return info;
}

ada4571_baseline to_baseline(const ada::Model &model) {
  ada4571_baseline baseline;
  baseline.struct_size = sizeof baseline;
  baseline.periods_per_turn = model.periods_per_turn;
  baseline.supply_v = model.supply_v;
  baseline.amplitude_v = model.baseline.amplitude_v;
  baseline.offset_sin_v = model.baseline.offset_sin_v;
  baseline.offset_cos_v = model.baseline.offset_cos_v;
  baseline.angle_zero_deg = model.baseline.angle_zero_deg;
  baseline.vtemp_reference_v = model.vtemp_reference_v;
  return baseline;
}

ada::Model from_baseline(const ada4571_baseline &baseline) {
  ada::Model model;
  model.periods_per_turn = baseline.periods_per_turn;
  model.supply_v = baseline.supply_v;
  model.baseline.amplitude_v = baseline.amplitude_v;
  model.baseline.offset_sin_v = baseline.offset_sin_v;
  model.baseline.offset_cos_v = baseline.offset_cos_v;
  model.baseline.angle_zero_deg = baseline.angle_zero_deg;
  model.vtemp_reference_v = baseline.vtemp_reference_v;
  ada::check_model(model);
  return model;
}

} // namespace

ada4571_parameter ada::capi::to_parameter(const ParameterInfo &info, double value,
                                          double std_error) {
  ada4571_parameter parameter;
  parameter.struct_size = sizeof parameter;
  parameter.name = c_string(info.name);
  parameter.unit = c_string(info.unit);
  // An infinite level of a clipper, say, is one that is not there.
  parameter.value = std::isfinite(value) ? value : std::nan("");
  parameter.std_error = std_error;
  return parameter;
}

extern "C" {

void ada4571_baseline_init(ada4571_baseline *baseline) {
  if (baseline != nullptr)
    *baseline = to_baseline(ada::Model());
}

void ada4571_effect_info_init(ada4571_effect_info *info) {
  if (info != nullptr)
    *info = {sizeof *info, "", "", "", 0, 0};
}

void ada4571_parameter_init(ada4571_parameter *parameter) {
  if (parameter != nullptr)
    *parameter = {sizeof *parameter, "", "", std::nan(""), std::nan("")};
}

size_t ada4571_catalogue_count(void) {
  return ada::catalogue().size();
}

ada4571_status ada4571_catalogue_get(size_t index, ada4571_effect_info *info) {
  return guard([&] {
    require_struct(info, "info");
    *info = to_info(at(ada::catalogue(), index, "effect")->info());
  });
}

ada4571_status ada4571_catalogue_parameter(size_t index, size_t parameter, ada4571_parameter *out) {
  return guard([&] {
    require_struct(out, "out");
    const ada::EffectInfo &effect = at(ada::catalogue(), index, "effect")->info();
    const ada::ParameterInfo &info = at(effect.parameters, parameter, "parameter");
    *out = to_parameter(info, info.fallback, std::nan(""));
  });
}

ada4571_status ada4571_catalogue_range(size_t index, size_t parameter, double *minimum,
                                       double *maximum) {
  return guard([&] {
    require(minimum, "minimum");
    require(maximum, "maximum");
    const ada::EffectInfo &effect = at(ada::catalogue(), index, "effect")->info();
    const ada::ParameterInfo &info = at(effect.parameters, parameter, "parameter");
    *minimum = info.minimum;
    *maximum = info.maximum;
  });
}

ada4571_status ada4571_model_new(const ada4571_baseline *baseline, ada4571_model **model) {
  return guard([&] {
    require_struct(baseline, "baseline");
    require(model, "model");
    *model = new ada4571_model{from_baseline(*baseline)};
  });
}

ada4571_status ada4571_model_load(const char *path, ada4571_model **model) {
  return guard([&] {
    require(path, "path");
    require(model, "model");
    *model = new ada4571_model{ada::read_model(path)};
  });
}

ada4571_status ada4571_model_save(const ada4571_model *model, const char *path) {
  return guard([&] {
    require(model, "model");
    require(path, "path");
    ada::write_model(model->impl, path);
  });
}

ada4571_status ada4571_model_get_baseline(const ada4571_model *model, ada4571_baseline *baseline) {
  return guard([&] {
    require(model, "model");
    require_struct(baseline, "baseline");
    *baseline = to_baseline(model->impl);
  });
}

ada4571_status ada4571_model_add_effect(ada4571_model *model, const char *text) {
  return guard([&] {
    require(model, "model");
    require(text, "text");
    ada::add_effect(model->impl, ada::parse_effect(text));
  });
}

size_t ada4571_model_effect_count(const ada4571_model *model) {
  return model ? model->impl.effects.size() : 0;
}

ada4571_status ada4571_model_effect(const ada4571_model *model, size_t index,
                                    ada4571_effect_info *info) {
  return guard([&] {
    require(model, "model");
    require_struct(info, "info");
    *info = to_info(at(model->impl.effects, index, "effect").effect->info());
  });
}

ada4571_status ada4571_model_parameter(const ada4571_model *model, size_t index, size_t parameter,
                                       ada4571_parameter *out) {
  return guard([&] {
    require(model, "model");
    require_struct(out, "out");
    const ada::EffectInstance &instance = at(model->impl.effects, index, "effect");
    const ada::ParameterInfo &info = at(instance.effect->info().parameters, parameter, "parameter");
    const double error =
        instance.std_errors.empty() ? std::nan("") : instance.std_errors[parameter];
    *out = to_parameter(info, instance.values[parameter], error);
  });
}

void ada4571_remainder_init(ada4571_remainder *remainder) {
  if (remainder != nullptr)
    *remainder = {sizeof *remainder, 0, 0, 0, 0.0};
}

ada4571_status ada4571_model_get_remainder(const ada4571_model *model,
                                           ada4571_remainder *remainder) {
  return guard([&] {
    require(model, "model");
    require_struct(remainder, "remainder");
    const auto &impl = model->impl.remainder;
    ada4571_remainder_init(remainder);
    if (impl)
      *remainder = {sizeof *remainder, 1, impl->electrical, impl->orders(),
                    impl->rms() * model->impl.baseline.amplitude_v};
  });
}

void ada4571_model_free(ada4571_model *model) {
  delete model;
}

} // extern "C"
