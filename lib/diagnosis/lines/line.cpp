// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/lines/line.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/lines/spectrum.h"

namespace ada {

Line line_of(const Residual &r, std::span<const double> sine, std::span<const double> cosine) {
  const auto n = static_cast<Eigen::Index>(r.time.size());
  const auto column = [n](std::span<const double> of) {
    return Eigen::Map<const Eigen::VectorXd>(of.data(), n);
  };
  const auto s = column(sine), c = column(cosine), x = column(r.sin_v), y = column(r.cos_v);
  const double scale = 2.0 / static_cast<double>(n);
  Line line{0.0, {scale * x.dot(s), scale * x.dot(c), scale * y.dot(s), scale * y.dot(c)}};
  for (double a : line.amplitudes)
    line.power += a * a;
  return line;
}

double tells_apart_s(const Residual &r) {
  const double span = r.time.back() - r.time.front();
  return r.stretch_s > 0.0 ? std::min(span, r.stretch_s) : span;
}

Line line_at(const Residual &r, double frequency) {
  return line_along(r, [&](std::size_t i) { return kTwoPi * frequency * r.time[i]; });
}

void take_out_line_of_radius(const Residual &r, double frequency, std::span<double> sin_v,
                             std::span<double> cos_v) {
  const std::size_t n = r.time.size();
  const auto phase = [&](std::size_t i) { return kTwoPi * frequency * r.time[i]; };
  const auto unit = [&](std::size_t i) {
    const Eigen::Vector2d to(r.model_sin_v[i] - r.centre_sin_v, r.model_cos_v[i] - r.centre_cos_v);
    return Eigen::Vector2d(to / std::max(to.norm(), 1e-9));
  };
  const auto row = [](const Eigen::Vector2d &u, double s, double c) {
    return Eigen::Vector4d(s * u[0], c * u[0], s * u[1], c * u[1]);
  };
  Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
  Eigen::Vector4d onto = Eigen::Vector4d::Zero();
  for_each_sincos(n, phase, [&](std::size_t i, double s, double c) {
    const Eigen::Vector2d u = unit(i);
    const Eigen::Vector4d of = row(u, s, c);
    products += of * of.transpose();
    onto += of * u.dot(Eigen::Vector2d(sin_v[i], cos_v[i]));
  });
  const Eigen::Vector4d of = solved(products, onto).col(0);
  for_each_sincos(n, phase, [&](std::size_t i, double s, double c) {
    const Eigen::Vector2d u = unit(i);
    const double along = of.dot(row(u, s, c));
    sin_v[i] -= along * u[0];
    cos_v[i] -= along * u[1];
  });
}

void take_out_line(std::span<const double> time, double frequency, std::span<double> sin_v,
                   std::span<double> cos_v) {
  const auto phase = [&](std::size_t i) { return kTwoPi * frequency * time[i]; };
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero(), onto = products; // onto: by channel
  for_each_sincos(time.size(), phase, [&](std::size_t i, double s, double c) {
    const Eigen::Vector2d row(s, c);
    products += row * row.transpose();
    onto += row * Eigen::RowVector2d(sin_v[i], cos_v[i]);
  });
  const Eigen::MatrixXd of = solved(products, onto);
  for_each_sincos(time.size(), phase, [&](std::size_t i, double s, double c) {
    sin_v[i] -= of(0, 0) * s + of(1, 0) * c;
    cos_v[i] -= of(0, 1) * s + of(1, 1) * c;
  });
}

bool rotates(const Line &tone) {
  const auto &a = tone.amplitudes;
  const double s = std::hypot(a[0], a[1]), c = std::hypot(a[2], a[3]);
  const double in_phase = (a[0] * a[2] + a[1] * a[3]) / std::max(s * c, 1e-30);
  return std::abs(in_phase) < 0.34 && std::max(s, c) < 1.3 * std::min(s, c);
}

std::vector<std::pair<double, Line>>
strongest_lines(const Residual &r, double above_hz,
                const std::function<bool(double, const Line &)> &skip) {
  const std::size_t n = r.time.size();
  const double span = n > 1 ? r.time.back() - r.time.front() : 0.0;
  if (n < kFewestForTones || !(r.sample_period_s > 0.0) || span <= 0.0)
    return {};
  const double resolution = 1.0 / tells_apart_s(r);
  PowerOverTime spectrum;
  for (const std::span<const double> channel : {r.sin_v, r.cos_v})
    add_power_over_time(
        r.time, r.sample_period_s, [&](std::size_t i) { return channel[i]; }, spectrum);
  const double bin = spectrum.bin_hz;
  const std::vector<float> &power = spectrum.power;
  // Every so manieth line tells the median of many: an odd stride meets no comb of lines.
  constexpr std::size_t kEnough = 8192;
  std::vector<float> some;
  for (std::size_t k = 1; k < power.size(); k += (power.size() / kEnough) | 1)
    some.push_back(power[k]);
  const double floor = quantile(std::move(some), 0.5);
  std::vector<std::pair<double, std::size_t>> peaks;
  const auto first =
      static_cast<std::size_t>(std::ceil(std::max(4.0 * resolution, above_hz) / bin));
  for (std::size_t k = std::max<std::size_t>(first, 2); k + 1 < power.size(); ++k)
    if (power[k] > 12.0 * floor && power[k] >= power[k - 1] && power[k] >= power[k + 1])
      peaks.emplace_back(power[k], k);
  std::sort(peaks.rbegin(), peaks.rend());
  std::vector<std::pair<double, Line>> out;
  std::size_t looked_at = 0;
  constexpr int kEitherSide = 4; // steps
  for (const auto &[p, k] : peaks) {
    if (out.size() == 2 || ++looked_at > 40)
      break;
    // The bin is coarse for a fit over the whole span: climb to the top of the line.
    double centre = static_cast<double>(k) * bin, step = 0.25 * bin;
    Line best = line_at(r, centre);
    if (skip(centre, best)) // most are; that shows at the bin already
      continue;
    for (int pass = 0; pass < 3; ++pass, step *= 0.25) {
      const double from = centre - kEitherSide * step;
      for_each_frequency(r.time, from, step, 2 * kEitherSide + 1,
                         [&](int at, const std::vector<double> &s, const std::vector<double> &c) {
                           const Line line = line_of(r, s, c);
                           if (line.power > best.power) {
                             best = line;
                             centre = from + at * step;
                           }
                         });
    }
    if (!skip(centre, best))
      out.emplace_back(centre, best);
  }
  return out;
}

namespace {

/// Whether a line is stronger seen from the turning pair, along the radius or across it: there a
/// gain or an angle that swings is one line, of which either channel has the two beside it.
bool is_of_the_turning_pair(const Residual &r, double frequency, const Line &line) {
  std::vector<double> along, across;
  double turning = 0.0; // of the pair, Hz
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    const double c = r.model_cos_v[i] - r.centre_cos_v, s = r.model_sin_v[i] - r.centre_sin_v;
    const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
    along.push_back(inverse * (r.cos_v[i] * c + r.sin_v[i] * s));
    across.push_back(inverse * (r.sin_v[i] * c - r.cos_v[i] * s));
    turning += std::abs(double{r.omega[i]}) * r.periods / kTwoPi;
  }
  turning /= static_cast<double>(std::max<std::size_t>(1, r.time.size()));
  Residual turned = r;
  turned.sin_v = along;
  turned.cos_v = across;
  double strongest = 0.0;
  for (double f : {frequency - turning, frequency, frequency + turning}) {
    const auto a = line_at(turned, f).amplitudes;
    strongest = std::max({strongest, a[0] * a[0] + a[1] * a[1], a[2] * a[2] + a[3] * a[3]});
  }
  return strongest > line.power;
}

} // namespace

void keep_single_lines(Residual r, std::vector<std::pair<double, Line>> &lines) {
  constexpr double kBeside = 1.5; // of the frequency
  constexpr double kOut = 10.0;   // of power
  std::array<std::vector<double>, 2> left{std::vector(r.sin_v.begin(), r.sin_v.end()),
                                          std::vector(r.cos_v.begin(), r.cos_v.end())};
  r.sin_v = left[0];
  r.cos_v = left[1];
  const auto spectrum = [&] {
    PowerOverTime out;
    for (const std::vector<double> &x : left)
      add_power_over_time(
          r.time, r.sample_period_s, [&](std::size_t i) { return x[i]; }, out);
    return out;
  };
  PowerOverTime before = spectrum();
  std::erase_if(lines, [&](const auto &found) {
    const double frequency = found.first;
    const Line line = line_at(r, frequency);
    const bool turning = rotates(line) || is_of_the_turning_pair(r, frequency, line);
    if (r.own_motion)
      take_out_line_of_radius(r, frequency, left[0], left[1]);
    else
      take_out_line(r.time, frequency, left[0], left[1]);
    PowerOverTime after = spectrum();
    const auto strongest = [&](const PowerOverTime &of) {
      const auto at = [&](double hz) {
        return of.power.begin() + std::min(static_cast<std::ptrdiff_t>(of.power.size()),
                                           static_cast<std::ptrdiff_t>(hz / of.bin_hz));
      };
      const auto first = at(frequency / kBeside), end = at(frequency * kBeside);
      return first < end ? *std::max_element(first, end) : 0.0F;
    };
    const bool many = strongest(before) < kOut * strongest(after);
    before = std::move(after);
    return many || turning;
  });
}

} // namespace ada
