// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/words.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace ada {

namespace {

/// The names of the causes, each once: "a", "a and b", "a, b and c".
struct Names {
  std::vector<std::string> each;
  std::string listed() const {
    std::string out;
    for (std::size_t i = 0; i < each.size(); ++i)
      out += (i == 0 ? "" : i + 1 == each.size() ? " and " : ", ") + each[i];
    return out;
  }
};

Names names_of(const Diagnosis &d) {
  Names out;
  for (const Finding &f : d.findings) {
    const std::string name = plain_name(f.effect->info().id);
    if (std::find(out.each.begin(), out.each.end(), name) == out.each.end())
      out.each.push_back(name);
  }
  return out;
}

/// "amplitude mismatch explains", "5 causes explain".
std::string subject(const Diagnosis &d, const char *verb) {
  const Names names = names_of(d);
  const std::string who =
      names.each.size() <= 3 ? names.listed() : counted(d.findings.size(), "cause");
  return fmt::format("{} {}{}", who, verb, names.each.size() == 1 ? "s" : "");
}

} // namespace

std::string headline(const Diagnosis &d) {
  const double rest = d.extended_quality.heldout.residual_rms_v;
  switch (d.verdict) {
  case Verdict::no_discrepancy:
    return fmt::format(
        "No discrepancy: the model describes this capture down to its noise, {} rms.",
        millivolts(rest));
  case Verdict::explained:
    return fmt::format("Explained: {} all that the model got wrong.", subject(d, "explain"));
  case Verdict::partly_explained:
    return fmt::format("Partly explained: {} a part; {} rms is left that no known cause explains.",
                       subject(d, "explain"), millivolts(d.unexplained_rms_v));
  case Verdict::unexplained:
    return fmt::format("Unexplained: the model is wrong by {} rms, and no known cause says how.",
                       millivolts(d.unexplained_rms_v));
  case Verdict::insufficient_data:
    break;
  }
  return "Not enough data: " + d.reason + ".";
}

std::string plain_name(std::string_view id) {
  std::string out(id);
  std::replace(out.begin(), out.end(), '-', ' ');
  return out;
}

Shown show(const ParameterInfo &info, double value, double std_error) {
  if (info.unit == "channel")
    return {value < 0.5 ? "VSIN" : "VCOS", {}, {}};
  Shown out{{}, {}, info.unit == "1" ? std::string() : std::string(info.unit)};
  const double size = std::max(std::abs(value), std_error);
  if ((info.unit == "s" || info.unit == "V") && size > 0.0 && size < 0.1) {
    const bool micro = size < 1e-3 && info.unit == "s";
    out.unit = (micro ? "\u00b5" : "m") + out.unit;
    value *= micro ? 1e6 : 1e3;
    std_error *= micro ? 1e6 : 1e3;
  }
  if (!(std_error > 0.0) || !std::isfinite(std_error)) {
    out.value = fmt::format("{:.6g}", value);
    return out;
  }
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(std_error)));
  if (decimals < 0 || decimals > 9) {
    out.value = fmt::format("{:.6g}", value);
    out.error = fmt::format("{:.2g}", std_error);
  } else {
    out.value = fmt::format("{:.{}f}", value, decimals);
    out.error = fmt::format("{:.{}f}", std_error, decimals);
  }
  return out;
}

std::string millivolts(double volts) {
  return std::abs(volts) < 1e-4 && volts != 0.0 ? fmt::format("{:.3g} \u00b5V", 1e6 * volts)
                                                : fmt::format("{:.3g} mV", 1e3 * volts);
}

std::string degrees(double deg) {
  return fmt::format("{:.3g}\u00b0", deg);
}

std::string counted(std::size_t n, const std::string &noun) {
  return n == 1 ? "one " + noun : fmt::format("{} {}s", n, noun);
}

} // namespace ada
