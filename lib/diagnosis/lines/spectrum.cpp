// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/lines/spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unsupported/Eigen/FFT>
#include <utility>

namespace ada {

namespace {

/// Values on an even grid, zeros between them; empty when the times span nothing.
template <class T> struct Grid {
  std::vector<T> at;
  double bin_hz = 0.0;
  template <class Value>
  Grid(std::span<const double> time, double sample_period_s, const Value &value) {
    constexpr std::size_t kFewest = 256, kMost = std::size_t{1} << 21;
    const double span = time.size() > 1 ? time.back() - time.front() : 0.0;
    if (!(sample_period_s > 0.0) || !(span > 0.0))
      return;
    std::size_t size = kFewest;
    while (static_cast<double>(size) * sample_period_s < span && size < kMost)
      size *= 2;
    const double step = std::max(sample_period_s, span / static_cast<double>(size - 1));
    bin_hz = 1.0 / (static_cast<double>(size) * step);
    at.resize(size);
    for (std::size_t i = 0; i < time.size(); ++i) {
      const auto k = static_cast<std::size_t>(std::lround((time[i] - time.front()) / step));
      if (k < size)
        at[k] = T(value(i));
    }
  }
};

/// Runs `with` on a transform that keeps the factors of earlier lengths, which cost a third of the
/// transform itself. Those of long records are given back: they are as large as the record.
template <class With> void on_transform(std::size_t n, bool half, const With &with) {
  constexpr std::size_t kKept = std::size_t{1} << 18;
  const auto flagged = [&](Eigen::FFT<float> &fft) -> Eigen::FFT<float> & {
    if (half)
      fft.SetFlag(Eigen::FFT<float>::HalfSpectrum);
    return fft;
  };
  if (n > kKept) {
    Eigen::FFT<float> fft;
    with(flagged(fft));
    return;
  }
  thread_local Eigen::FFT<float> whole_kept, half_kept;
  with(flagged(half ? half_kept : whole_kept));
}

} // namespace

Spectrum spectrum_over_time(std::span<const double> time, double sample_period_s,
                            const std::function<std::complex<double>(std::size_t)> &value) {
  const Grid<std::complex<float>> in(time, sample_period_s, value);
  Spectrum out{{}, in.bin_hz};
  if (!in.at.empty())
    on_transform(in.at.size(), false, [&](Eigen::FFT<float> &fft) { fft.fwd(out.line, in.at); });
  return out;
}

void add_power_over_time(std::span<const double> time, double sample_period_s,
                         const std::function<double(std::size_t)> &value, PowerOverTime &out) {
  const Grid<float> in(time, sample_period_s, value);
  out.bin_hz = in.bin_hz;
  if (in.at.empty())
    return;
  std::vector<std::complex<float>> line;
  on_transform(in.at.size(), true, [&](Eigen::FFT<float> &fft) { fft.fwd(line, in.at); });
  out.power.resize(in.at.size() / 2);
  for (std::size_t k = 0; k < out.power.size(); ++k)
    out.power[k] += std::norm(line[k]);
}

std::vector<RowLine> standing_lines(std::span<const double> row, double fewest_periods,
                                    double chance) {
  constexpr std::size_t kMost = 8;
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
  // The last line of an even row has one number where the others have two: half of its square is
  // its part of the sum of squares, and no likelier to be large than theirs.
  std::vector<std::pair<double, std::size_t>> by_power;
  double in_all = 0.0, in_band = 0.0;
  for (std::size_t k = 1; 2 * k <= n; ++k) {
    const double power = (2 * k == n ? 0.5 : 1.0) * std::norm(line[k]);
    in_all += power;
    if (k < first)
      continue;
    in_band += power;
    by_power.emplace_back(power, k);
  }
  std::sort(by_power.rbegin(), by_power.rend());
  std::vector<RowLine> out;
  for (const auto &[power, k] : by_power) {
    const double lines = static_cast<double>(by_power.size() - out.size());
    if (out.size() == kMost || !(in_band > 0.0) ||
        lines * std::pow(1.0 - std::min(1.0, power / in_band), lines - 1.0) > chance)
      break;
    out.push_back({static_cast<double>(k), power / in_all});
    in_band -= power;
  }
  return out;
}

} // namespace ada
