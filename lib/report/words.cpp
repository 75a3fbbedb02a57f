// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/words.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "base/plain_numbers.h"
#include "diagnosis/diagnose.h"

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
    const std::string name(f.effect->info().id);
    if (std::find(out.each.begin(), out.each.end(), name) == out.each.end())
      out.each.push_back(name);
  }
  return out;
}

/// Without the sign of what is nothing in so many digits.
std::string fixed(double value, int decimals) {
  std::string out = fmt::format("{:.{}f}", value, decimals);
  if (out[0] == '-' && out.find_first_of("123456789") == std::string::npos)
    out.erase(0, 1);
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
    if (d.findings.empty())
      return fmt::format("Explained: the causes that the model names describe this capture down to "
                         "its noise, {} rms.",
                         millivolts(rest));
    return fmt::format("Explained: {} all that the model got wrong.", subject(d, "explain"));
  case Verdict::partly_explained:
    return fmt::format(
        "Partly explained: {} a part; {} rms is left that no known cause explains.",
        d.findings.empty() ? "the causes that the model names explain" : subject(d, "explain"),
        millivolts(d.unexplained_rms_v));
  case Verdict::unexplained:
    return fmt::format("Unexplained: the model is wrong by {} rms, and no known cause says how.",
                       millivolts(d.unexplained_rms_v));
  case Verdict::insufficient_data:
    break;
  }
  return "Not enough data: " + without_stop(d.reason) + ".";
}

std::string baseline_words(const Diagnosis &d) {
  return d.baseline_name == DiagnosisOptions().baseline_name ? "the application note's model"
                                                             : d.baseline_name;
}

std::string meaning(Axis axis, bool has_reference) {
  switch (axis) {
  case Axis::angle:
    return has_reference ? "repeats at the same angle of the shaft"
                         : "repeats at the same angle, of the shaft or of the electrical period";
  case Axis::speed:
    return "changes with the speed or the sense of rotation";
  case Axis::temperature:
    return "changes with VTEMP";
  case Axis::supply:
    return "follows VDD";
  case Axis::time:
    return "changes slowly during the record";
  case Axis::frequency:
    return "tones that do not turn with the shaft";
  case Axis::noise:
    break;
  }
  return "what no model could predict";
}

std::string Shown::in_full() const {
  return value + (error.empty() ? "" : " \u00b1 " + error) + (unit.empty() ? "" : " " + unit);
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
    out.value = fixed(value, decimals);
    out.error = fixed(std_error, decimals);
  }
  return out;
}

std::string millivolts(double volts) {
  return std::abs(volts) < 1e-4 && volts != 0.0
             ? fmt::format("{:.3g} \u00b5V", 1e6 * volts)
             : in_plain_numbers(fmt::format("{:.3g} mV", 1e3 * volts));
}

std::string degrees(double deg) {
  return fmt::format("{:.3g}\u00b0", deg);
}

std::string change(const std::string &before, const std::string &after) {
  return before == after ? after : before + " \u2192 " + after;
}

std::string without_stop(std::string text) {
  while (!text.empty() && text.back() == '.')
    text.pop_back();
  return text;
}

std::string sentence(std::string text) {
  text = without_stop(std::move(text));
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text + ".";
}

std::string counted(std::size_t n, const std::string &noun) {
  return n == 1 ? "one " + noun : fmt::format("{} {}s", n, noun);
}

} // namespace ada
