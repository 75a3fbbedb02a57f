// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "base/angle.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

constexpr std::size_t kLongest = 8192, kShortest = 64, kEnough = 8, kMostSamples = 130000;
constexpr double kStepsPerDecade = 70.0;

/// Adds |FFT|^2 of one segment of both channels, windowed.
void accumulate(const ResidualColumns &r, const std::vector<double> &window,
                Eigen::FFT<double> &fft, std::vector<double> &power) {
  std::vector<std::complex<double>> in(window.size()), out;
  for (const auto *channel : {&r.sin, &r.cos}) {
    for (std::size_t i = 0; i < in.size(); ++i)
      in[i] = window[i] * (*channel)[i];
    fft.fwd(out, in);
    for (std::size_t k = 0; k < power.size(); ++k)
      power[k] += std::norm(out[k]);
  }
}

/// First samples of stretches of `length` neighbours.
std::vector<std::size_t> segments(const Observations &data, std::size_t length) {
  std::vector<std::size_t> out;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= data.size(); ++i) {
    const bool broken =
        i == data.size() || data.time[i] - data.time[i - 1] > 1.5 * data.frame_period_s;
    if (broken)
      begin = i;
    else if (i + 1 - begin == length) {
      out.push_back(begin);
      begin = i + 1;
    }
  }
  return out;
}

/// As many as are worth the time, spread over the record.
std::vector<std::size_t> some_of(const std::vector<std::size_t> &all, std::size_t length) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < all.size(); k += all.size() * length / kMostSamples + 1)
    out.push_back(all[k]);
  return out;
}

/// Joins neighbouring lines to one step of the logarithmic axis. `power`: one a model, at k
/// lines_hz.
Spectrum joined(const std::vector<std::vector<double>> &power, double line_hz, double scale) {
  Spectrum out;
  out.density.resize(power.size());
  const std::size_t lines = power.front().size();
  out.highest_hz = line_hz * static_cast<double>(lines);
  const double step = std::pow(10.0, 1.0 / kStepsPerDecade);
  for (std::size_t first = 1; first < lines;) {
    const std::size_t end = std::min(
        lines,
        std::max(first + 1, static_cast<std::size_t>(static_cast<double>(first) * step + 0.5)));
    out.frequency_hz.push_back(
        line_hz * std::sqrt(static_cast<double>(first) * static_cast<double>(end - 1)));
    for (std::size_t m = 0; m < power.size(); ++m) {
      double sum = 0.0, most = 0.0;
      for (std::size_t k = first; k < end; ++k) {
        sum += power[m][k];
        most = std::max(most, power[m][k]);
      }
      out.density[m].mean.push_back(1e6 *
                                    std::sqrt(scale * sum / static_cast<double>(end - first)));
      out.density[m].peak.push_back(1e6 * std::sqrt(scale * most));
    }
    first = end;
  }
  return out;
}

} // namespace

Spectrum residual_spectrum(const Observations &data, const std::vector<const Model *> &models) {
  std::size_t length = kLongest;
  std::vector<std::size_t> starts;
  for (; length >= kShortest; length /= 2) {
    starts = segments(data, length);
    if (starts.size() >= kEnough)
      break;
  }
  if (starts.size() < kEnough || !(data.frame_period_s > 0.0))
    return {};
  starts = some_of(starts, length);
  std::vector<double> window(length);
  double weight = 0.0;
  for (std::size_t i = 0; i < length; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(i) / static_cast<double>(length));
    weight += window[i] * window[i];
  }
  std::vector<std::vector<double>> power(models.size(), std::vector<double>(length / 2, 0.0));
  Eigen::FFT<double> fft;
  std::vector<std::uint32_t> index(length);
  for (std::size_t first : starts) {
    for (std::size_t i = 0; i < length; ++i)
      index[i] = static_cast<std::uint32_t>(first + i);
    const Observations part = data.select(index);
    for (std::size_t m = 0; m < models.size(); ++m)
      accumulate(residuals_alone(part, *models[m]), window, fft, power[m]);
  }
  // One-sided density, mean of both channels.
  const double rate = 1.0 / data.frame_period_s;
  return joined(power, rate / static_cast<double>(length),
                2.0 / (rate * weight * 2.0 * static_cast<double>(starts.size())));
}

} // namespace ada
