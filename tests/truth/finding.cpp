// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "finding.h"

#include <cstdio>

namespace truth {
namespace {

std::string quoted(const std::string &text) {
  return '"' + text + '"';
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string list(const std::vector<std::string> &names) {
  std::string text = "[";
  for (const std::string &name : names)
    text += (text.size() > 1 ? ", " : "") + quoted(name);
  return text + "]";
}

std::string object(const Parameter &parameter) {
  if (!parameter.text.empty())
    return "{\"text\": " + quoted(parameter.text) + "}";
  std::string text = "{\"value\": " + number(parameter.value) +
                     ", \"unit\": " + quoted(parameter.unit) +
                     ", \"tolerance\": " + number(parameter.tolerance);
  if (parameter.period > 0.0)
    text += ", \"period\": " + number(parameter.period);
  if (parameter.has_other)
    text += ", \"other\": " + number(parameter.other);
  return text + "}";
}

} // namespace

void write_json(std::ostream &out, const Expectation &expectation, const std::string &category,
                const std::string &description, unsigned long long seed) {
  out << "{\n \"schema\": \"ada4571-truth/1\",\n \"seed\": " << seed
      << ",\n \"category\": " << quoted(category) << ",\n \"description\": " << quoted(description)
      << ",\n \"effects\": [";
  const char *separator = "\n";
  for (const Truth &truth : expectation.effects) {
    out << separator << "  {\"cause\": " << quoted(truth.cause)
        << ", \"accept\": " << list(truth.accept) << ", \"require\": " << list(truth.require)
        << ",\n   \"parameters\": {";
    const char *comma = "";
    for (const auto &[name, parameter] : truth.parameters) {
      out << comma << "\n    " << quoted(name) << ": " << object(parameter);
      comma = ",";
    }
    out << "}}";
    separator = ",\n";
  }
  out << "],\n \"tolerated\": " << list(expectation.tolerated)
      << ",\n \"verdicts\": " << list(expectation.verdicts) << ",\n \"unexplained\": "
      << (expectation.unexplained_open ? "null"
          : expectation.unexplained    ? "true"
                                       : "false")
      << ",\n \"named_instead\": " << list(expectation.named_instead)
      << ",\n \"axis\": " << quoted(expectation.axis)
      << ",\n \"noise_rms_v\": " << number(expectation.noise_rms_v)
      << ",\n \"amplitude_v\": " << number(expectation.amplitude_v)
      << ",\n \"periods_per_turn\": " << expectation.periods_per_turn << "\n}\n";
}

} // namespace truth
