// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/profile.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "base/angle.h"
#include "base/error.h"

namespace ada {

PiecewiseLinear::PiecewiseLinear(std::vector<Node> nodes) : nodes_(std::move(nodes)) {
  integral_.push_back(nodes_.front().value * nodes_.front().time_s);
  for (std::size_t i = 1; i < nodes_.size(); ++i)
    integral_.push_back(integral_.back() + 0.5 * (nodes_[i].value + nodes_[i - 1].value) *
                                               (nodes_[i].time_s - nodes_[i - 1].time_s));
}

std::size_t PiecewiseLinear::segment(double time_s) const {
  const auto after = std::upper_bound(nodes_.begin(), nodes_.end(), time_s,
                                      [](double t, const Node &n) { return t < n.time_s; });
  return static_cast<std::size_t>(after - nodes_.begin());
}

double PiecewiseLinear::value(double t) const {
  const std::size_t k = segment(t);
  if (k == 0)
    return nodes_.front().value;
  if (k == nodes_.size())
    return nodes_.back().value;
  return nodes_[k - 1].value + slope(t) * (t - nodes_[k - 1].time_s);
}

double PiecewiseLinear::slope(double t) const {
  const std::size_t k = segment(t);
  if (k == 0 || k == nodes_.size())
    return 0.0;
  return (nodes_[k].value - nodes_[k - 1].value) / (nodes_[k].time_s - nodes_[k - 1].time_s);
}

double PiecewiseLinear::integral(double t) const {
  const std::size_t k = segment(t);
  if (k == 0)
    return nodes_.front().value * t;
  const Node &from = nodes_[k - 1];
  return integral_[k - 1] + 0.5 * (from.value + value(t)) * (t - from.time_s);
}

namespace {

/// "kind:key=value,key=value" taken apart.
struct Text {
  std::string whole, kind;
  std::map<std::string, std::string> values;

  [[noreturn]] void fail(const std::string &why) const {
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "'" + whole + "': " + why);
  }
  double number(const std::string &text) const {
    double value = 0.0;
    const char *end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value))
      fail("'" + text + "' is not a number");
    return value;
  }
  double get(const std::string &key, double fallback) {
    const auto it = values.find(key);
    if (it == values.end())
      return fallback;
    const double value = number(it->second);
    values.erase(it);
    return value;
  }
  std::vector<double> list(const std::string &key, const std::string &fallback) {
    std::string text = fallback;
    if (const auto it = values.find(key); it != values.end()) {
      text = it->second;
      values.erase(it);
    }
    std::vector<double> out;
    for (std::size_t from = 0; from <= text.size();) {
      const std::size_t to = std::min(text.find('/', from), text.size());
      out.push_back(number(text.substr(from, to - from)));
      from = to + 1;
    }
    return out;
  }
  void done() const {
    if (!values.empty())
      fail("unknown key '" + values.begin()->first + "'");
  }
};

Text parse(const std::string &text) {
  Text out;
  out.whole = text;
  const std::size_t colon = std::min(text.find(':'), text.size());
  out.kind = text.substr(0, colon);
  for (std::size_t from = colon + 1; from < text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string item = text.substr(from, to - from);
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos)
      out.fail("'" + item + "' is not KEY=VALUE");
    out.values[item.substr(0, equals)] = item.substr(equals + 1);
    from = to + 1;
  }
  return out;
}

constexpr const char *kMotions[] = {"constant:rpm=600", "ramp:from=60,to=3000",
                                    "steps:rpm=300/900/-900/-300,transition=0.2"};
constexpr const char *kTemperatures[] = {"constant:deg_c=25", "ramp:from=-20,to=100",
                                         "cycle:from=0,to=80"};

/// VTEMP is within the supply there; the part itself is made for less.
constexpr double kLowest_c = -70.0, kHighest_c = 230.0;
/// Beyond any shaft: at that speed one of 0.2 mm has a rim at 10 km/s.
constexpr double kFastest_rpm = 1e9;

/// Plateaus with straight transitions between them; `transition` is a part of each plateau.
std::vector<PiecewiseLinear::Node> plateaus(const std::vector<double> &levels, double transition,
                                            double duration_s) {
  std::vector<PiecewiseLinear::Node> nodes;
  const double each = duration_s / static_cast<double>(levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double start = each * static_cast<double>(i);
    nodes.push_back({i == 0 ? 0.0 : start + 0.5 * transition * each, levels[i]});
    nodes.push_back({start + each * (1.0 - 0.5 * transition), levels[i]});
  }
  return nodes;
}

} // namespace

PiecewiseLinear parse_motion(const std::string &text, double duration_s) {
  const double rad_per_s = kTwoPi / 60.0;
  const double span = duration_s > 0.0 ? duration_s : 10.0;
  Text t = parse(text);
  std::vector<PiecewiseLinear::Node> nodes;
  if (t.kind == "constant") {
    nodes = {{0.0, t.get("rpm", 600.0)}};
  } else if (t.kind == "ramp") {
    nodes = {{0.0, t.get("from", 60.0)}, {span, t.get("to", 3000.0)}};
  } else if (t.kind == "steps") {
    const double transition = t.get("transition", 0.2);
    if (transition <= 0.0 || transition >= 1.0)
      t.fail("transition must lie between 0 and 1");
    nodes = plateaus(t.list("rpm", "300/900/-900/-300"), transition, span);
  } else {
    t.fail("a motion is constant:rpm=R, ramp:from=R,to=R or steps:rpm=R/R/...,transition=PART");
  }
  t.done();
  for (auto &node : nodes) {
    if (std::fabs(node.value) > kFastest_rpm)
      t.fail("a speed must be from -1e9 to 1e9 rpm");
    node.value *= rad_per_s;
  }
  return PiecewiseLinear(std::move(nodes));
}

std::span<const char *const> motion_examples() {
  return kMotions;
}

std::span<const char *const> temperature_examples() {
  return kTemperatures;
}

PiecewiseLinear parse_temperature(const std::string &text, double duration_s) {
  const double span = duration_s > 0.0 ? duration_s : 600.0;
  Text t = parse(text);
  std::vector<PiecewiseLinear::Node> nodes;
  if (t.kind == "constant") {
    nodes = {{0.0, t.get("deg_c", 25.0)}};
  } else if (t.kind == "ramp") {
    nodes = {{0.0, t.get("from", -20.0)}, {span, t.get("to", 100.0)}};
  } else if (t.kind == "cycle") {
    const double from = t.get("from", 0.0);
    nodes = {{0.0, from}, {0.5 * span, t.get("to", 80.0)}, {span, from}};
  } else {
    t.fail("a temperature is constant:deg_c=T, ramp:from=T,to=T or cycle:from=T,to=T");
  }
  t.done();
  for (const auto &node : nodes)
    if (node.value < kLowest_c || node.value > kHighest_c)
      t.fail("a temperature must be from -70 to 230 degrees Celsius");
  return PiecewiseLinear(std::move(nodes));
}

} // namespace ada
