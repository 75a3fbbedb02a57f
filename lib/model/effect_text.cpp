// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/effect_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/text.h"

namespace ada {

namespace {

[[noreturn]] void fail(const std::string &what) {
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT, what);
}

double parse_value(const ParameterInfo &parameter, std::string_view text) {
  if (parameter.unit == "channel" && (text == "vsin" || text == "vcos"))
    return text == "vsin" ? 0.0 : 1.0;
  if (may_be_absent(parameter) && text == "none")
    return std::nan("");
  const auto value = parse_number(text);
  if (!value)
    fail(std::string(parameter.name) + " is not a number: " + excerpt(text));
  if (const std::string problem = check_parameter(parameter, *value); !problem.empty())
    fail(std::string(parameter.name) + " " + problem + ", not " + excerpt(text));
  return *value;
}

/// A parameter that marks where an effect sits.
bool marks_place(const ParameterInfo &parameter) {
  return parameter.role == Role::chosen || parameter.name == "frequency_hz";
}

/// Who names one of the parameters that may be absent means the others to be absent: a clipping at
/// low_v alone has no level above.
void leave_out_what_was_not_given(const EffectInfo &info, const std::vector<bool> &given,
                                  std::vector<double> &values) {
  bool any = false;
  for (std::size_t i = 0; i < values.size(); ++i)
    any |= given[i] && may_be_absent(info.parameters[i]);
  for (std::size_t i = 0; any && i < values.size(); ++i)
    if (!given[i] && may_be_absent(info.parameters[i]))
      values[i] = std::nan("");
}

template <class Range, class Name> std::string join(const Range &range, Name name) {
  std::string out;
  for (const auto &item : range)
    out += (out.empty() ? "" : ", ") + std::string(name(item));
  return out;
}

} // namespace

bool may_be_absent(const ParameterInfo &parameter) {
  if (parameter.role == Role::chosen)
    return std::isnan(parameter.fallback);
  return parameter.role == Role::fitted && std::isinf(parameter.minimum) &&
         std::isinf(parameter.maximum);
}

std::string check_parameter(const ParameterInfo &parameter, double value) {
  if (std::isnan(value) && may_be_absent(parameter))
    return {};
  if (parameter.unit == "channel")
    return value == 0.0 || value == 1.0 ? "" : "must be vsin or vcos";
  if (value >= parameter.minimum && value <= parameter.maximum && std::isfinite(value))
    return {};
  if (std::isinf(parameter.minimum) && std::isinf(parameter.maximum))
    return "must be a finite number";
  return "must be from " + shortest(parameter.minimum) + " to " + shortest(parameter.maximum);
}

bool repeats(const EffectInstance &a, const EffectInstance &b) {
  if (a.effect != b.effect)
    return false;
  const auto parameters = a.effect->info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (marks_place(parameters[i]) && a.values[i] != b.values[i] &&
        !(std::isnan(a.values[i]) && std::isnan(b.values[i])))
      return false;
  return true;
}

std::string known_effects() {
  return join(catalogue(), [](const Effect *effect) { return effect->info().id; });
}

std::string known_parameters(const EffectInfo &info) {
  if (info.parameters.empty())
    return "none";
  return join(info.parameters, [](const ParameterInfo &p) { return p.name; });
}

std::size_t find_parameter(const EffectInfo &info, std::string_view name) {
  const auto it = std::find_if(info.parameters.begin(), info.parameters.end(),
                               [&](const ParameterInfo &p) { return p.name == name; });
  return static_cast<std::size_t>(it - info.parameters.begin());
}

EffectInstance parse_effect(std::string_view text) {
  const auto colon = text.find(':');
  const auto name = trim(text.substr(0, colon));
  EffectInstance instance;
  instance.effect = find_effect(name);
  if (instance.effect == nullptr)
    fail("no effect is called " + excerpt(name) + "; there are " + known_effects());
  const EffectInfo &info = instance.effect->info();
  for (const ParameterInfo &parameter : info.parameters)
    instance.values.push_back(parameter.fallback);
  if (colon == text.npos)
    return instance;

  std::vector<bool> given(info.parameters.size());
  for (auto rest = text.substr(colon + 1);;) {
    const auto comma = rest.find(',');
    const auto pair = trim(rest.substr(0, comma));
    const auto equals = std::min(pair.find('='), pair.size());
    const auto key = trim(pair.substr(0, equals));
    if (equals == pair.size() || key.empty())
      fail(std::string(name) + " expects parameter=value, not " + excerpt(pair));
    const std::size_t index = find_parameter(info, key);
    if (index == info.parameters.size())
      fail(std::string(name) + " has no parameter " + excerpt(key) +
           "; there are: " + known_parameters(info));
    if (given[index])
      fail(std::string(name) + ": " + std::string(key) + " is given twice");
    given[index] = true;
    try {
      instance.values[index] = parse_value(info.parameters[index], trim(pair.substr(equals + 1)));
    } catch (const Error &e) {
      fail(std::string(name) + ": " + e.what());
    }
    if (comma == rest.npos)
      break;
    rest.remove_prefix(comma + 1);
  }
  leave_out_what_was_not_given(info, given, instance.values);
  return instance;
}

void add_effect(Model &model, EffectInstance instance) {
  const EffectInfo &info = instance.effect->info();
  if (const std::string why = instance.effect->contradiction(instance.values); !why.empty())
    fail(std::string(info.id) + ": " + why);
  const bool placed = std::any_of(info.parameters.begin(), info.parameters.end(), marks_place);
  for (const EffectInstance &other : model.effects)
    if (repeats(other, instance))
      fail("the model already has " + std::string(info.id) + (placed ? " at this place" : ""));
  model.effects.push_back(std::move(instance));
}

} // namespace ada
