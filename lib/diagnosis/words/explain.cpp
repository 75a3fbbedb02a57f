// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/words/explain.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace ada {

namespace {

std::string_view experiment_between(const Effect &a, std::string_view b) {
  for (const Separation &s : a.info().separations)
    if (s.rival == b)
      return s.experiment;
  if (const Effect *other = find_effect(b))
    for (const Separation &s : other->info().separations)
      if (s.rival == a.info().id)
        return s.experiment;
  return "a capture at other speeds, in both directions and at another temperature";
}

} // namespace

std::string separation(const Effect &effect, const std::vector<std::string> &rivals) {
  std::vector<std::string_view> said;
  std::string out;
  for (const std::string &rival : rivals) {
    const std::string_view experiment = experiment_between(effect, rival);
    if (std::find(said.begin(), said.end(), experiment) != said.end())
      continue;
    said.push_back(experiment);
    out += fmt::format("{}{}", out.empty() ? "" : "; ", experiment);
  }
  return out;
}

std::string parameter_text(const ParameterInfo &info, double value, double std_error) {
  if (info.unit == "channel")
    return fmt::format("{} {}", info.name, value < 0.5 ? "vsin" : "vcos");
  std::string unit = info.unit == "1" ? "" : fmt::format(" {}", info.unit);
  if (std_error > 0.0 && std::isfinite(std_error)) {
    // Digits up to the second of the error.
    const double digits = std::ceil(std::log10(std::abs(value) / std_error)) + 2.0;
    const int n = static_cast<int>(std::clamp(std::isfinite(digits) ? digits : 3.0, 2.0, 10.0));
    return fmt::format("{} = {:.{}g} +- {:.2g}{}", info.name, value, n, std_error, unit);
  }
  return fmt::format("{} = {:.6g}{}", info.name, value, unit);
}

std::string explanation(const Finding &finding) {
  const EffectInfo &info = finding.effect->info();
  std::string out(info.cause);
  std::string numbers;
  for (std::size_t k = 0; k < info.parameters.size(); ++k)
    if (!std::isnan(finding.values[k]))
      numbers +=
          fmt::format("{}{}", numbers.empty() ? "" : ", ",
                      parameter_text(info.parameters[k], finding.values[k],
                                     k < finding.std_errors.size() ? finding.std_errors[k] : 0.0));
  if (!numbers.empty())
    out += " (" + numbers + ")";
  return out;
}

std::string in_words(const ReferenceCourse &c) {
  std::vector<std::string> parts;
  if (c.scale_error > 0.0)
    parts.push_back(fmt::format(
        "goes {:.{}f} +- {:.2g} degrees for each that the pair turns", c.scale,
        static_cast<int>(std::clamp(1.0 - std::log10(c.scale_error), 3.0, 9.0)), c.scale_error));
  if (c.drift_error > 0.0)
    parts.push_back(fmt::format("drifts by {:.4g} +- {:.2g} deg/s", c.drift_deg_s, c.drift_error));
  if (c.clock_error > 0.0)
    parts.push_back(fmt::format("is late by {} and {} ({:+.4g} +- {:.2g} us for each second): its "
                                "clock is not the pair's, or a delay drifts",
                                c.clock_ppm < 0.0 ? "less" : "more",
                                c.clock_ppm < 0.0 ? "less" : "more", c.clock_ppm, c.clock_error));
  if (c.bend_deg > 0.0)
    parts.push_back(fmt::format("bends by {:.3g} deg beside that", c.bend_deg));
  const bool clock = c.clock_error > 0.0;
  const char *or_else = clock                  ? ""
                        : c.drift_error <= 0.0 ? ": its scale, or a drift"
                        : c.scale_error <= 0.0 ? ", or its scale does where the shaft turns evenly"
                                               : "";
  std::string out = fmt::format("the reference {}{}{}; the pair is judged without that",
                                fmt::join(parts, " and "), or_else,
                                clock ? "" : "; a magnet that creeps on its shaft looks the same");
  if (c.within_a_turn)
    out +=
        ". Within one turn an error once a turn, of the sensor or of the reference, may look so: "
        "a record of several turns would tell";
  return out;
}

} // namespace ada
