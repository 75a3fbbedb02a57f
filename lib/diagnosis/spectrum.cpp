// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/spectrum.h"

#include <algorithm>
#include <cmath>
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

} // namespace ada
