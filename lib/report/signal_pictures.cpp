// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "report/pictures.h"
#include "report/script.h"
#include "report/svg.h"

namespace ada {

namespace {

const char *channel(bool sin) {
  return sin ? "VSIN" : "VCOS";
}

const char *key_label(const Stretch &t) {
  return t.over_angle ? "shaft angle, deg" : "time since the start, s";
}

/// Whether samples are missing before this one, so that no line may lead to it.
bool gap_before(const Stretch &t, std::size_t i) {
  if (i == 0 || t.over_angle)
    return false;
  const double typical = (t.key.back() - t.key.front()) / static_cast<double>(t.key.size());
  return t.key[i] - t.key[i - 1] > 4.0 * typical;
}

std::string key_range(const std::vector<double> &key, int tics = 7) {
  if (key.empty())
    return {};
  const auto [low, high] = std::minmax_element(key.begin(), key.end());
  return range_with_tics("x", *low, *high, tics) + "set lmargin 7\n";
}

} // namespace

Picture stretch_picture(const View &view, int periods) {
  const Stretch &t = view.stretch;
  std::string rows;
  for (std::size_t i = 0; i < t.key.size(); ++i)
    rows += fmt::format("{}{:.10g} {:.5f} {:.5f} {:.5f} {:.5f}\n", gap_before(t, i) ? "\n" : "",
                        t.key[i], t.vsin[i], t.vcos[i], t.extended_sin[i], t.extended_cos[i]);
  std::string s = panel({700, 230}, "", "volts") + key_range(t.key) + "set yrange [*:*]\n";
  s += block("pair", rows);
  // The measured pair is broad and pale, so that it frames the simulated one where both coincide.
  const char *wide = t.over_angle ? "points pt 7 ps 0.6" : "lines lw 7";
  s += fmt::format("plot $pair using 1:2 with {2} lc rgb {0}, $pair using 1:3 with {2} lc rgb {0}, "
                   "$pair using 1:4 with lines lc rgb {1} lw 1.6, $pair using 1:5 with lines "
                   "lc rgb {1} lw 1.6 dt (7,4)\n",
                   kPale, kAfter, wide);
  return {s, fmt::format("VSIN and VCOS, simulated lines within the measured ones, {} samples, {} "
                         "electrical periods a turn",
                         t.key.size(), periods)};
}

Picture stretch_residual_picture(const View &view, bool sin) {
  const Stretch &t = view.stretch;
  const std::vector<double> &measured = sin ? t.vsin : t.vcos;
  const std::vector<double> &base = sin ? t.base_sin : t.base_cos;
  const std::vector<double> &extended = sin ? t.extended_sin : t.extended_cos;
  std::string rows;
  double limit = 0.0; // of both channels, so that their pictures compare
  for (std::size_t i = 0; i < t.key.size(); ++i) {
    const double before = 1e3 * (measured[i] - base[i]);
    const double after = 1e3 * (measured[i] - extended[i]);
    for (const double v : {t.vsin[i] - t.base_sin[i], t.vsin[i] - t.extended_sin[i],
                           t.vcos[i] - t.base_cos[i], t.vcos[i] - t.extended_cos[i]})
      limit = std::max(limit, 1e3 * std::abs(v));
    rows += fmt::format("{}{:.10g} {:.4g} {:.4g}\n", gap_before(t, i) ? "\n" : "", t.key[i], before,
                        after);
  }
  limit = limit > 0.0 ? 1.1 * limit : 1.0;
  std::string s = panel({700, 150}, sin ? "" : key_label(t),
                        fmt::format("{} measured minus simulated, mV", channel(sin))) +
                  key_range(t.key) + range_with_tics("y", -limit, limit, 3);
  const char *with = t.over_angle ? "points pt 7 ps 0.3" : "lines lw 1.2";
  s += block("rest", rows);
  s +=
      fmt::format("plot $rest using 1:2 with {0} lc rgb {1}, $rest using 1:3 with {0} lc rgb {2}\n",
                  with, kBefore, kAfter);
  return {s, fmt::format("{} measured minus simulated over the same stretch, before and after",
                         channel(sin))};
}

double locus_factor(const View &view, double amplitude_v) {
  const Locus &l = view.locus;
  double deviation = 0.0;
  for (std::size_t i = 0; i < l.base_sin.size(); ++i)
    for (double d : {std::hypot(l.base_dsin[i], l.base_dcos[i]),
                     std::hypot(l.extended_dsin[i], l.extended_dcos[i])})
      if (std::isfinite(d))
        deviation = std::max(deviation, d);
  const double most = deviation > 0.0 ? 0.3 * amplitude_v / deviation : 1.0;
  double factor = 1.0;
  for (double decade = 1.0; decade <= 1e3; decade *= 10.0)
    for (double step : {1.0, 2.0, 5.0})
      if (decade * step <= most)
        factor = decade * step;
  return std::min(factor, 1000.0);
}

Picture locus_picture(const View &view, double factor, double amplitude_v) {
  const Locus &l = view.locus;
  std::string rows;
  std::size_t first = l.base_sin.size();
  const auto row = [&](std::size_t i) {
    rows += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f}\n", l.base_cos[i], l.base_sin[i],
                        l.base_cos[i] + factor * l.base_dcos[i],
                        l.base_sin[i] + factor * l.base_dsin[i],
                        l.extended_cos[i] + factor * l.extended_dcos[i],
                        l.extended_sin[i] + factor * l.extended_dsin[i]);
  };
  for (std::size_t i = 0; i < l.base_sin.size(); ++i) {
    if (!std::isfinite(l.base_sin[i]))
      continue;
    first = std::min(first, i);
    row(i);
  }
  if (first < l.base_sin.size())
    row(first); // a closed curve
  const double half = 1.45 * std::abs(amplitude_v);
  std::string s = panel({420, 400}, "VCOS, V", "VSIN, V") + "set size ratio -1\nunset xzeroaxis\n";
  s += range_with_tics("x", l.centre_cos_v - half, l.centre_cos_v + half, 5);
  s += range_with_tics("y", l.centre_sin_v - half, l.centre_sin_v + half, 5);
  s += block("pair", rows);
  s += fmt::format("plot $pair using 1:2 with lines lc rgb {} lw 6, $pair using 3:4 with lines lc "
                   "rgb {} lw 1.8, $pair using 5:6 with lines lc rgb {} lw 1.8\n",
                   kPale, kBefore, kAfter);
  return {s, fmt::format("VSIN against VCOS: the simulated curve and the mean measured one, its "
                         "deviation enlarged {:g} times",
                         factor)};
}

Picture raw_picture(const Capture &capture) {
  std::string rows;
  const std::size_t step = capture.size() / 600 + 1;
  std::vector<double> time;
  double low = capture.vsin_v.front(), high = low;
  for (std::size_t i = 0; i < capture.size(); i += step) {
    low = std::min({low, capture.vsin_v[i], capture.vcos_v[i]});
    high = std::max({high, capture.vsin_v[i], capture.vcos_v[i]});
    time.push_back(capture.time_s[i] - capture.time_s.front());
    rows +=
        fmt::format("{:.10g} {:.6g} {:.6g}\n", time.back(), capture.vsin_v[i], capture.vcos_v[i]);
  }
  const double room = 0.05 * (high - low);
  std::string s = panel({700, 250}, "time since the start, s", "volts") + key_range(time) +
                  range_with_tics("y", low - room, high + room, 5) + block("pair", rows);
  s += fmt::format("plot $pair using 1:2 with points pt 7 ps 0.45 lc rgb {}, $pair using 1:3 with "
                   "points pt 6 ps 0.45 lc rgb {}\n",
                   kAfter, kBefore);
  return {s, "VSIN and VCOS as measured"};
}

Picture envelope_picture(const Record &r, bool sin, double expected_v) {
  std::string rows;
  const double expected = 1e3 * expected_v;
  double low = -expected, high = expected;
  for (std::size_t i = 0; i < r.time_s.size(); ++i) {
    const Extremes &e = r.extremes[i];
    const double from = sin ? e.sin_low : e.cos_low, to = sin ? e.sin_high : e.cos_high;
    rows += fmt::format("{:.8g} {:.5g} {:.5g}\n", r.time_s[i], from, to);
    low = std::min(low, from);
    high = std::max(high, to);
  }
  const double room = 0.06 * (high - low);
  std::string s = panel(kHalf, "time since the start, s",
                        fmt::format("{}, least and largest, mV", channel(sin)));
  s += key_range(r.time_s, 5) + range_with_tics("y", low - room, high + room, 4) +
       block("extremes", rows);
  s += fmt::format(
      "plot $extremes using 1:2:3 with filledcurves fc rgb {0} fs transparent solid 0.45 "
      "border lc rgb {0}, {1:.5g} with lines dt (6,4) lc rgb {2} lw 1.4, {3:.5g} with "
      "lines dt (6,4) lc rgb {2} lw 1.4\n",
      kAfter, expected, kFloor, -expected);
  return {s, fmt::format("least and largest residual of {} over time: {:.3g} to {:.3g} mV",
                         channel(sin), low, high)};
}

Picture worst_picture(const Record &r) {
  std::string rows;
  double low = 0.0, high = 0.0;
  std::vector<double> time;
  const double reach = r.near_s.empty() ? 0.0 : std::max(-r.near_s.front(), r.near_s.back());
  const double scale = reach < 1e-3 ? 1e6 : reach < 1.0 ? 1e3 : 1.0;
  for (std::size_t i = 0; i < r.near_s.size(); ++i) {
    time.push_back(scale * r.near_s[i]);
    rows += fmt::format("{:.8g} {:.5g} {:.5g}\n", time.back(), r.near_sin[i], r.near_cos[i]);
    low = std::min({low, r.near_sin[i], r.near_cos[i]});
    high = std::max({high, r.near_sin[i], r.near_cos[i]});
  }
  const double room = 0.1 * (high - low);
  std::string s = panel(kHalf,
                        fmt::format("{} from the largest deviation, {:.6g} s after the start",
                                    scale > 1e3   ? "\u00b5s"
                                    : scale > 1.0 ? "ms"
                                                  : "s",
                                    r.worst_s - r.start_s),
                        "the largest deviation and its neighbours, mV");
  s += key_range(time, 5) + range_with_tics("y", low - room, high + room, 4) + block("near", rows);
  s += fmt::format(
      "plot $near using 1:2 with linespoints lc rgb {} lw 1.2 pt 7 ps 0.4, $near using 1:3 "
      "with linespoints lc rgb {} lw 1.2 pt 6 ps 0.5\n",
      kAfter, kSecond);
  return {s, fmt::format("the samples about the largest deviation, {:.3g} mV of {}",
                         1e3 * r.worst_v, channel(r.worst_in_sin))};
}

} // namespace ada
