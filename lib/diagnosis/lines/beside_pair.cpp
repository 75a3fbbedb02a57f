// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/lines/beside_pair.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "base/angle.h"
#include "base/sincos.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"

namespace ada {

Rounded::Rounded(const Residual &r) : view(r) {
  constexpr double kFlattest = 0.05; // of the mean squares along the two axes: flatter is no turn
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    const Eigen::Vector2d x(r.model_sin_v[i] - r.centre_sin_v, r.model_cos_v[i] - r.centre_cos_v);
    spread += x * x.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(spread);
  if (!(axes.eigenvalues()[0] > kFlattest * axes.eigenvalues()[1]))
    return;
  const Eigen::Matrix2d round = std::sqrt(0.5 * spread.trace()) * axes.operatorInverseSqrt();
  const auto turn = [&](const auto &sin, const auto &cos, double sin0, double cos0,
                        std::size_t to) {
    for (std::size_t i = 0; i < sin.size(); ++i) {
      const Eigen::Vector2d x = round * Eigen::Vector2d(sin[i] - sin0, cos[i] - cos0);
      column[to].push_back(x[0] + sin0);
      column[to + 1].push_back(x[1] + cos0);
    }
  };
  turn(r.sin_v, r.cos_v, 0.0, 0.0, 0);
  turn(r.model_sin_v, r.model_cos_v, r.centre_sin_v, r.centre_cos_v, 2);
  view.sin_v = column[0];
  view.cos_v = column[1];
  view.model_sin_v = column[2];
  view.model_cos_v = column[3];
}

MostlyAt mostly_at(const Residual &r) {
  constexpr double kOneSpeed = 0.02; // from the slowest to the fastest of them
  std::vector<double> sorted(r.omega.begin(), r.omega.end());
  std::sort(sorted.begin(), sorted.end());
  std::size_t from = 0, most = 0;
  double slowest = 0.0, fastest = 0.0;
  for (std::size_t to = 0; to < sorted.size(); ++to) {
    while (sorted[to] - sorted[from] > kOneSpeed * std::abs(sorted[to]))
      ++from;
    if (to - from + 1 > most) {
      most = to - from + 1;
      slowest = sorted[from];
      fastest = sorted[to];
    }
  }
  MostlyAt out{{}, std::abs(0.5 * (slowest + fastest)) * r.periods / kTwoPi};
  for (std::size_t i = 0; i < r.omega.size(); ++i)
    if (r.omega[i] >= slowest && r.omega[i] <= fastest)
      out.samples.push_back(i);
  return out;
}

bool goes_to_and_fro(const Residual &r) {
  const auto [low, high] = std::minmax_element(r.omega.begin(), r.omega.end());
  return *low < 0.0 && *high > 0.0;
}

bool rotates_with_pair(const Residual &r, const MostlyAt &at, double frequency, const Line &line) {
  if (!goes_to_and_fro(r))
    return rotates(line);
  Residual one = r;
  std::array<std::vector<double>, 3> column;
  for (std::size_t i : at.samples) {
    column[0].push_back(r.time[i]);
    column[1].push_back(r.sin_v[i]);
    column[2].push_back(r.cos_v[i]);
  }
  one.time = column[0];
  one.sin_v = column[1];
  one.cos_v = column[2];
  return rotates(line_at(one, frequency));
}

bool one_sided(const Residual &r, const MostlyAt &at, double frequency) {
  constexpr double kAlike = 0.25;
  double strongest = 0.0;
  bool out = false;
  for (double f : {std::abs(frequency - at.turning), frequency + at.turning}) {
    std::complex<double> radial, tangential;
    for_each_sincos(
        at.samples.size(), [&](std::size_t k) { return kTwoPi * f * r.time[at.samples[k]]; },
        [&](std::size_t k, double sine, double cosine) {
          const std::size_t i = at.samples[k];
          const double c = r.model_cos_v[i] - r.centre_cos_v;
          const double s = r.model_sin_v[i] - r.centre_sin_v;
          const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
          const std::complex<double> wave(inverse * cosine, inverse * sine);
          radial += wave * (r.cos_v[i] * c + r.sin_v[i] * s);
          tangential += wave * (r.sin_v[i] * c - r.cos_v[i] * s);
        });
    const double u = std::norm(radial), v = std::norm(tangential);
    if (u + v > strongest) {
      strongest = u + v;
      out = std::min(u, v) < kAlike * std::max(u, v);
    }
  }
  return out;
}

bool has_fellow(const Residual &r, const MostlyAt &at, double frequency) {
  constexpr double kAlike = 0.3, kWidths = 3.0;
  const auto power = [&](double f) {
    std::complex<double> sin, cos;
    for_each_sincos(
        at.samples.size(), [&](std::size_t k) { return kTwoPi * f * r.time[at.samples[k]]; },
        [&](std::size_t k, double sine, double cosine) {
          const std::complex<double> wave(cosine, sine);
          sin += wave * r.sin_v[at.samples[k]];
          cos += wave * r.cos_v[at.samples[k]];
        });
    return std::norm(sin) + std::norm(cos);
  };
  const double here = power(frequency);
  // The lines of so few samples are as wide as this.
  const double width = 1.0 / (static_cast<double>(at.samples.size()) * r.sample_period_s);
  for (double fellow : {std::abs(2.0 * at.turning - frequency), 2.0 * at.turning + frequency})
    if (std::abs(fellow - frequency) > kWidths * width && power(fellow) > kAlike * here)
      return true;
  return false;
}

bool slow_beside_pair(const Residual &r, double frequency) {
  constexpr double kMost = 0.5;
  const double span = r.time.back() - r.time.front();
  const double band = 0.5 * criteria::kMostTrends / span; // half waves
  std::size_t near = 0;
  for (double w : r.omega)
    near += std::abs(std::abs(w) * r.periods / kTwoPi - frequency) < band;
  return static_cast<double>(near) > kMost * static_cast<double>(r.omega.size());
}

} // namespace ada
