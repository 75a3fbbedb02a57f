// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Finds missing samples in the time column of a stream, at constant cost.
#pragma once

#include <algorithm>
#include <cmath>

namespace ada {

/// A step of time counts as a gap when it is longer than 1.5 usual steps and stands out of the
/// usual scatter of the steps, so that a ragged clock is not taken for a row of gaps. Usual means
/// a running median, which single long steps cannot move much.
class GapDetector {
public:
  /// Whether samples are missing before this one.
  bool operator()(double time_s) {
    const double step = time_s - last_;
    last_ = time_s;
    if (!(step > 0)) // the first sample, time running back, or no number
      return false;
    if (seen_ < kLearn) {
      ++seen_;
      typical_ += (step - typical_) / seen_;
      scatter_ += (std::abs(step - typical_) - scatter_) / seen_;
      return false;
    }
    const bool gap = step > 1.5 * typical_ && step > typical_ + 12 * scatter_;
    const double rate = 0.02 * typical_;
    typical_ += std::clamp(step - typical_, -rate, rate);
    scatter_ += std::clamp(std::abs(step - typical_) - scatter_, -rate, rate);
    return gap;
  }

  void reset() { *this = GapDetector(); }

private:
  static constexpr int kLearn = 16;
  double last_ = std::nan("");
  double typical_ = 0, scatter_ = 0;
  int seen_ = 0;
};

} // namespace ada
