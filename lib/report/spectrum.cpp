// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/spectrum.h"

#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "base/angle.h"
#include "diagnosis/fit.h"

namespace ada {

namespace {

constexpr std::size_t kSegment = 1024, kMostSegments = 60;

/// Adds |FFT|^2 of one segment of both channels, windowed.
void accumulate(const ResidualColumns &r, const std::vector<double> &window,
                Eigen::FFT<double> &fft, std::vector<double> &power) {
  std::vector<std::complex<double>> in(kSegment), out;
  for (const auto *channel : {&r.sin, &r.cos}) {
    for (std::size_t i = 0; i < kSegment; ++i)
      in[i] = window[i] * (*channel)[i];
    fft.fwd(out, in);
    for (std::size_t k = 0; k < power.size(); ++k)
      power[k] += std::norm(out[k]);
  }
}

/// First samples of stretches of kSegment neighbours, spread over the record.
std::vector<std::size_t> segments(const Observations &data) {
  std::vector<std::size_t> all, out;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= data.size(); ++i) {
    const bool broken =
        i == data.size() || data.time[i] - data.time[i - 1] > 1.5 * data.frame_period_s;
    if (broken)
      begin = i;
    else if (i + 1 - begin == kSegment) {
      all.push_back(begin);
      begin = i + 1;
    }
  }
  const std::size_t step = all.size() / kMostSegments + 1;
  for (std::size_t k = 0; k < all.size(); k += step)
    out.push_back(all[k]);
  return out;
}

} // namespace

Spectrum residual_spectrum(const Observations &data, const std::vector<const Model *> &models) {
  Spectrum out;
  const std::vector<std::size_t> starts = segments(data);
  if (starts.size() < 3 || !(data.frame_period_s > 0.0))
    return out;
  std::vector<double> window(kSegment);
  double weight = 0.0;
  for (std::size_t i = 0; i < kSegment; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(i) / kSegment);
    weight += window[i] * window[i];
  }
  std::vector<std::vector<double>> power(models.size(), std::vector<double>(kSegment / 2, 0.0));
  Eigen::FFT<double> fft;
  std::vector<std::uint32_t> index(kSegment);
  for (std::size_t first : starts) {
    for (std::size_t i = 0; i < kSegment; ++i)
      index[i] = static_cast<std::uint32_t>(first + i);
    const Observations part = data.select(index);
    for (std::size_t m = 0; m < models.size(); ++m)
      accumulate(residual_columns(part, *models[m]), window, fft, power[m]);
  }
  // One-sided density, mean of both channels.
  const double rate = 1.0 / data.frame_period_s;
  const double scale = 2.0 / (rate * weight * 2.0 * static_cast<double>(starts.size()));
  out.density.resize(models.size());
  for (std::size_t k = 1; k < kSegment / 2; ++k) {
    out.frequency_hz.push_back(rate * static_cast<double>(k) / kSegment);
    for (std::size_t m = 0; m < models.size(); ++m)
      out.density[m].push_back(1e6 * std::sqrt(power[m][k] * scale));
  }
  return out;
}

} // namespace ada
