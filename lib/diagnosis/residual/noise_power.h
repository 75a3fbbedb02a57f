// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Whether the power of the noise is the same at all times and at all places of the turn.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/solve.h"
#include "diagnosis/residual/components.h"
#include "diagnosis/words/result.h"

namespace ada {

/// Power of noise along and across the vector where the two channels differ, are correlated, or
/// share a noise of the supply, the gain or the angle: each goes with twice the electrical angle on
/// its own; what comes of a scatter of instants goes across with the square of the speed as well.
class NoisePower {
public:
  /// `passes`: whether both outputs follow what comes before them. One that stands at its stop has
  /// no noise of the sensor.
  NoisePower(const Observations &data, const Components &split, const std::vector<char> &passes)
      : data_(data), split_(split), passes_(passes), across_(split.judged.size() > 1) {
    double sum = 0.0;
    for (double w : data.omega)
      sum += w * w;
    mean_omega2_ = sum / static_cast<double>(std::max<std::size_t>(1, data.size()));
    along_law_ = law(2);
    if (across_)
      across_law_ = law(3);
  }

  /// Parts of a sample over the root of the power that is expected of them: of the radius, 0, and
  /// where there is a reference of the angle, 1.
  template <typename Take> void each(Take take) const {
    for (std::size_t i = 0; i < split_.cos2.size(); ++i) {
      if (!passes_[i])
        continue;
      take(i, 0, split_.of[2][i] / std::sqrt(at(along_law_, i)));
      if (across_)
        take(i, 1, split_.of[3][i] / std::sqrt(at(across_law_, i)));
    }
  }

private:
  /// Of the mean power at a speed: a channel with a tenth of the noise of the other. Of the mean
  /// over all speeds: a speed at which next to nothing scatters.
  static constexpr double kLeastOfMean = 0.01, kLeastOfAll = 1e-4;
  using Row = Eigen::Vector4d;

  double square(int component, std::size_t i) const {
    return split_.of[component][i] * split_.of[component][i];
  }
  Row row(std::size_t i) const {
    const double speed = mean_omega2_ > 0.0 ? data_.omega[i] * data_.omega[i] / mean_omega2_ : 1.0;
    return {1.0, split_.cos2[i], split_.sin2[i], speed - 1.0};
  }
  /// The square of a normal variable scatters in proportion to its mean: weighted by the law
  /// itself, and so a few times over (Nelder and Wedderburn, J. R. Stat. Soc. A 135, 1972).
  Row law(int component) const {
    constexpr int kPasses = 5;
    Row out = Row::Zero();
    for (int pass = 0; pass < kPasses; ++pass) {
      Eigen::Matrix4d normal = Eigen::Matrix4d::Identity() * 1e-9;
      Row right = Row::Zero();
      for (std::size_t i = 0; i < split_.cos2.size(); ++i) {
        if (!passes_[i])
          continue;
        Row x = row(i);
        if (component == 2)
          x[3] = 0.0;
        const double weight = pass == 0 ? 1.0 : std::pow(out[0] / at(out, i), 2);
        normal += weight * x * x.transpose();
        right += weight * x * square(component, i);
      }
      out = solved(normal, right);
      if (!(out[0] > 0.0))
        break;
    }
    return out;
  }
  double at(const Row &of, std::size_t i) const {
    const Row x = row(i);
    const double at_speed = std::max(of[0] + of[3] * x[3], kLeastOfAll * of[0]);
    return std::max({of.dot(x), kLeastOfMean * at_speed, 1e-300});
  }

  const Observations &data_;
  const Components &split_;
  const std::vector<char> &passes_;
  bool across_;
  double mean_omega2_ = 0.0;
  Row along_law_ = Row::Zero(), across_law_ = Row::Zero();
};

/// Noise that comes and goes with time, or with the place in the turn. `of`: one sentence about the
/// bins by power over the mean.
void report_variance(const NoisePower &power, const Memory &memory, const std::vector<int> &bin,
                     int bins, double sigma, double least, const char *along,
                     const std::function<std::string(const std::vector<double> &)> &sentence,
                     std::vector<Structure> &out);

/// `power`: of the bins, over its mean.
std::string sentence_of_times(const std::vector<double> &power);
/// By places in the turn, in even bins.
std::string sentence_of_places(const std::vector<double> &power);

} // namespace ada
