// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/effect.h"

#include <cmath>

#include "model/effect_text.h"

namespace ada {

std::string_view stage_name(Stage stage) {
  switch (stage) {
  case Stage::motion:
    return "motion";
  case Stage::field:
    return "field";
  case Stage::bridge:
    return "bridge";
  case Stage::chain:
    return "chain";
  case Stage::sampler:
    return "sampler";
  case Stage::converter:
    return "converter";
  case Stage::record:
    return "record";
  }
  return "";
}

std::vector<double> Effect::to_coordinates(Values values) const {
  std::vector<double> x;
  const auto parameters = info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].role == Role::fitted)
      x.push_back(values[i]);
  return x;
}

std::vector<double> Effect::from_coordinates(Values values, std::span<const double> x) const {
  std::vector<double> out(values.begin(), values.end());
  const auto parameters = info().parameters;
  std::size_t k = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].role == Role::fitted)
      out[i] = x[k++];
  return out;
}

std::vector<double> Effect::steps(Values) const {
  std::vector<double> h;
  for (const ParameterInfo &p : info().parameters)
    if (p.role == Role::fitted)
      h.push_back(p.step);
  return h;
}

std::vector<std::vector<double>> Effect::guesses(const Residual &) const {
  std::vector<double> values;
  for (const ParameterInfo &p : info().parameters)
    values.push_back(may_be_absent(p) && p.role == Role::chosen ? std::nan("") : 0.0);
  return {values};
}

} // namespace ada
