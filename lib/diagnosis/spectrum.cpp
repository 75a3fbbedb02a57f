// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unsupported/Eigen/FFT>

namespace ada {

Spectrum spectrum_over_time(std::span<const double> time, double sample_period_s,
                            const std::function<std::complex<double>(std::size_t)> &value) {
  constexpr std::size_t kFewest = 256, kMost = std::size_t{1} << 21;
  const double span = time.size() > 1 ? time.back() - time.front() : 0.0;
  if (!(sample_period_s > 0.0) || !(span > 0.0))
    return {};
  std::size_t size = kFewest;
  while (static_cast<double>(size) * sample_period_s < span && size < kMost)
    size *= 2;
  const double grid = std::max(sample_period_s, span / static_cast<double>(size - 1));
  std::vector<std::complex<float>> in(size);
  for (std::size_t i = 0; i < time.size(); ++i) {
    const auto k = static_cast<std::size_t>(std::lround((time[i] - time.front()) / grid));
    if (k < size)
      in[k] = std::complex<float>(value(i));
  }
  Spectrum out;
  out.bin_hz = 1.0 / (static_cast<double>(size) * grid);
  Eigen::FFT<float> fft;
  fft.fwd(out.line, in);
  return out;
}

RowLine strongest_line(std::span<const double> row, double fewest_periods) {
  const std::size_t n = row.size();
  const std::size_t first =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(fewest_periods)));
  if (n < 2 * first + 4)
    return {};
  std::vector<double> in(row.begin(), row.end());
  const double mean = std::accumulate(in.begin(), in.end(), 0.0) / static_cast<double>(n);
  for (double &v : in)
    v -= mean;
  std::vector<std::complex<double>> line;
  Eigen::FFT<double> fft;
  fft.fwd(line, in);
  double in_all = 0.0, in_band = 0.0, most = 0.0;
  RowLine out;
  for (std::size_t k = 1; 2 * k < n; ++k) { // the last line of an even row has one number only
    const double power = std::norm(line[k]);
    in_all += power;
    if (k < first)
      continue;
    in_band += power;
    if (power > most) {
      most = power;
      out.periods = static_cast<double>(k);
    }
  }
  if (!(in_band > 0.0))
    return {};
  out.share = most / in_all;
  const double lines = static_cast<double>((n - 1) / 2 - first + 1);
  out.chance = std::min(1.0, lines * std::pow(1.0 - most / in_band, lines - 1.0));
  return out;
}

} // namespace ada
