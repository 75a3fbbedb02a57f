// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/fit.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/solve.h"
#include "diagnosis/anonymous/discrepancy.h"
#include "diagnosis/criteria.h"
#include "diagnosis/over_samples.h"
#include "model/forward.h"

namespace ada {

namespace {

constexpr std::size_t kBaseline = 4;
/// Of the weight that white noise would give. Along what the part without a name takes for its own
/// a step would go anywhere: this keeps it near, and moves no minimum (Levenberg, Q. Appl. Math. 2,
/// 1944, p. 164).
constexpr double kDamping = 1e-3;
/// A step that gains less of the sum of squares is the last: of 60,000 values it is 0.03 nats.
constexpr double kStill = 1e-6;

/// Normal equations at one point, and the sum of squares there.
struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  double rss = 0.0;
  Eigen::MatrixXd damping; ///< added to the matrix for a step, not for errors
  Eigen::MatrixXd white;   ///< the matrix without what has no name; empty where that is nothing
};

Normal normal_equations(const Observations &data, const Model &model, const std::vector<double> &x,
                        const std::vector<double> &step) {
  const auto parameters = static_cast<Eigen::Index>(x.size());
  ForwardFamily models(model, AlphaIs::reference);
  std::vector<double> moved = x;
  for (std::size_t k = 0; k < x.size(); ++k) {
    moved[k] = x[k] + step[k];
    models.add(with_coordinates(model, moved));
    moved[k] = x[k];
  }
  const Conditions all = data.conditions();
  const Coloured *coloured = data.coloured.get();
  const auto add = [&](Crosses &sums, std::size_t first, std::size_t n) {
    std::array<double, kWaveBlock> s0, c0;
    std::array<Observations::Whitener, kWaveBlock> whiten;
    Eigen::MatrixXd rows(parameters + 1, static_cast<Eigen::Index>(2 * n));
    models.evaluate(all.slice(first, n), [&](std::size_t k, const double *sin, const double *cos) {
      if (k == 0) {
        std::copy_n(sin, n, s0.data());
        std::copy_n(cos, n, c0.data());
        for (std::size_t i = 0; i < n; ++i)
          whiten[i] = data.whitener_at(first + i, s0[i], c0[i]);
      }
      const auto row = k == 0 ? parameters : static_cast<Eigen::Index>(k - 1);
      const double inverse = k == 0 ? 1.0 : 1.0 / step[k - 1];
      for (std::size_t i = 0; i < n; ++i) {
        double s = k == 0 ? data.vsin[first + i] - s0[i] : (sin[i] - s0[i]) * inverse;
        double c = k == 0 ? data.vcos[first + i] - c0[i] : (cos[i] - c0[i]) * inverse;
        whiten[i](s, c);
        rows(row, static_cast<Eigen::Index>(2 * i)) = s;
        rows(row, static_cast<Eigen::Index>(2 * i + 1)) = c;
      }
    });
    sums.add(rows, first, coloured);
  };
  Crosses sums = sum_over(data.size(), Crosses(parameters + 1, coloured), add);
  Eigen::MatrixXd &products = sums.products;
  Eigen::MatrixXd damping = Eigen::MatrixXd::Zero(parameters, parameters), white;
  if (coloured) {
    damping = kDamping * products.topLeftCorner(parameters, parameters);
    damping.triangularView<Eigen::StrictlyUpper>() = damping.transpose();
    white = damping / kDamping;
    products -= coloured->taken(sums.projected);
  }
  products.triangularView<Eigen::StrictlyUpper>() = products.transpose();
  Normal out{products.topLeftCorner(parameters, parameters), products.topRightCorner(parameters, 1),
             products(parameters, parameters), std::move(damping), std::move(white)};
  if (data.vtemp_on_vcos_error > 0.0) {
    // One more measurement, weighted by its error against the noise of the samples.
    const double sigma = std::sqrt(out.rss / (2.0 * static_cast<double>(data.size())));
    const double weight = sigma / data.vtemp_on_vcos_error;
    const double now = vtemp_on_vcos(model);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(parameters);
    for (std::size_t k = 0; k < x.size(); ++k) {
      moved[k] = x[k] + step[k];
      row[static_cast<Eigen::Index>(k)] =
          weight * (vtemp_on_vcos(with_coordinates(model, moved)) - now) / step[k];
      moved[k] = x[k];
    }
    out.matrix += row * row.transpose();
    out.right += row * weight * (data.vtemp_on_vcos - now);
  }
  return out;
}

/// Inverse of a symmetric matrix whose columns differ in scale by orders of magnitude.
struct Scaled {
  Eigen::VectorXd scale;
  Eigen::LDLT<Eigen::MatrixXd> solver;
  bool determined;
  explicit Scaled(const Eigen::MatrixXd &m) {
    scale = m.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd unit = scale.asDiagonal() * m * scale.asDiagonal();
    solver.compute(unit);
    determined = solver.info() == Eigen::Success && solver.vectorD().minCoeff() > 1e-10;
  }
  Eigen::VectorXd solve(const Eigen::VectorXd &b) const {
    return scale.asDiagonal() * solver.solve(scale.asDiagonal() * b);
  }
  Eigen::MatrixXd inverse() const {
    const Eigen::Index n = scale.size();
    return scale.asDiagonal() * solver.solve(Eigen::MatrixXd::Identity(n, n)) * scale.asDiagonal();
  }
};

} // namespace

double vtemp_on_vcos(const Model &model) {
  double sum = 0.0;
  for (const EffectInstance &e : model.effects)
    sum += e.effect->vtemp_on_vcos(e.values);
  return sum;
}

std::vector<double> coordinates_of(const Model &model) {
  const Baseline &b = model.baseline;
  std::vector<double> x{b.amplitude_v, b.offset_sin_v, b.offset_cos_v, b.angle_zero_deg};
  for (const EffectInstance &e : model.effects)
    for (double c : e.effect->to_coordinates(e.values))
      x.push_back(c);
  return x;
}

Model with_coordinates(const Model &model, std::span<const double> x) {
  Model out = model;
  out.baseline = {x[0], x[1], x[2], x[3]};
  std::size_t k = kBaseline;
  for (EffectInstance &e : out.effects) {
    const std::size_t n = e.effect->to_coordinates(e.values).size();
    e.values = e.effect->from_coordinates(e.values, x.subspan(k, n));
    k += n;
  }
  return out;
}

std::vector<double> coordinate_steps(const Model &model) {
  std::vector<double> h{1e-4, 1e-4, 1e-4, 1e-3};
  for (const EffectInstance &e : model.effects)
    for (double step : e.effect->steps(e.values))
      h.push_back(step);
  return h;
}

namespace {

double sum_of_squares(const Observations &data, const Model &model, const Coloured *coloured) {
  const ForwardModel forward(model, AlphaIs::reference);
  const Conditions all = data.conditions();
  const auto add = [&](Crosses &sums, std::size_t first, std::size_t n) {
    std::array<double, kWaveBlock> s, c;
    Eigen::MatrixXd row(1, static_cast<Eigen::Index>(2 * n));
    forward.evaluate(all.slice(first, n), s.data(), c.data());
    for (std::size_t i = 0; i < n; ++i) {
      double rs = data.vsin[first + i] - s[i], rc = data.vcos[first + i] - c[i];
      data.whiten(first + i, s[i], c[i], rs, rc);
      row(0, static_cast<Eigen::Index>(2 * i)) = rs;
      row(0, static_cast<Eigen::Index>(2 * i + 1)) = rc;
    }
    sums.add(row, first, coloured);
  };
  const Crosses sums = sum_over(data.size(), Crosses(1, coloured), add);
  const double sum = sums.products(0, 0);
  return coloured ? std::max(0.0, sum - coloured->taken(sums.projected)(0, 0)) : sum;
}

} // namespace

double sum_of_squares(const Observations &data, const Model &model) {
  return sum_of_squares(data, model, data.coloured.get());
}

double white_sum_of_squares(const Observations &data, const Model &model) {
  return sum_of_squares(data, model, nullptr);
}

FitResult fit(const Observations &data, const Model &start, int max_iterations) {
  std::vector<double> x = coordinates_of(start);
  Model model = start;
  FitResult out;
  Normal here;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    here = normal_equations(data, model, x, coordinate_steps(model));
    out.rss = here.rss;
    const Scaled scaled(here.matrix + here.damping);
    if (!scaled.determined)
      break;
    Eigen::VectorXd step = scaled.solve(here.right);
    if (!step.allFinite())
      break;
    // Damped steps that follow are taken on the same parabola: only how far it holds needs another.
    for (; iteration + 1 < max_iterations && !here.damping.isZero(0.0); ++iteration) {
      const Eigen::VectorXd left = here.right - here.matrix * step, more = scaled.solve(left);
      if (!more.allFinite() || more.dot(left) < kStill * here.rss)
        break;
      step += more;
    }
    bool better = false, as_expected = false;
    const double expected = 2.0 * step.dot(here.right) - step.dot(here.matrix * step);
    for (double part = 1.0; part > 0.05; part *= 0.5) {
      std::vector<double> next = x;
      for (std::size_t k = 0; k < x.size(); ++k)
        next[k] += part * step[static_cast<Eigen::Index>(k)];
      Model trial = with_coordinates(model, next);
      // The same figure with the zero half a period away: no sensor, and no model file has it.
      if (trial.baseline.amplitude_v <= 0.0)
        continue;
      const double rss = sum_of_squares(data, trial);
      if (rss <= here.rss * (1.0 + 1e-12)) {
        x = std::move(next);
        model = std::move(trial);
        out.rss = rss;
        better = true;
        // How far the sum is from where a parabola would have taken it bounds what is left to gain.
        as_expected = part == 1.0 && std::abs(here.rss - expected - rss) < kStill * here.rss;
        break;
      }
    }
    // The normal equations of one step before are those of the end, near enough for a covariance.
    if (!better || as_expected || expected < kStill * here.rss)
      break;
  }
  const Scaled scaled(here.matrix);
  out.determined = scaled.determined;
  out.model = std::move(model);
  const double freedom =
      std::max(1.0, 2.0 * static_cast<double>(data.size()) - static_cast<double>(x.size()));
  out.covariance = scaled.inverse() * (out.rss / freedom);
  if (here.white.size() > 0) {
    const Eigen::VectorXd of_noise = Scaled(here.white).inverse().diagonal() * (out.rss / freedom);
    out.unnamed_share = 1.0 - (of_noise.array() / out.covariance.diagonal().array()).min(1.0);
  }
  return out;
}

void widen_by_scatter(const Observations &data, FitResult &result) {
  const std::size_t stretches =
      std::min<std::size_t>(criteria::kStretches, data.size() / criteria::kFewestOfStretch);
  if (stretches < criteria::kFewestStretches || !result.determined)
    return;
  const std::vector<double> x = coordinates_of(result.model), step = coordinate_steps(result.model);
  const auto parameters = static_cast<Eigen::Index>(x.size());
  const ResidualColumns here = residual_columns(data, result.model);
  const auto n = static_cast<Eigen::Index>(data.size());
  Eigen::VectorXd left(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    double s = here.sin[k], c = here.cos[k];
    data.whiten(k, here.model_sin[k], here.model_cos[k], s, c);
    left[2 * i] = s;
    left[2 * i + 1] = c;
  }
  if (data.coloured)
    left = data.coloured->unexplained(left);
  Eigen::MatrixXd score = Eigen::MatrixXd::Zero(parameters, static_cast<Eigen::Index>(stretches));
  std::vector<double> moved = x;
  for (Eigen::Index k = 0; k < parameters; ++k) {
    const auto at = static_cast<std::size_t>(k);
    moved[at] = x[at] + step[at];
    const ResidualColumns there = residual_columns(data, with_coordinates(result.model, moved));
    moved[at] = x[at];
    Eigen::VectorXd column(2 * n);
    for (std::size_t i = 0; i < data.size(); ++i) {
      double s = (there.model_sin[i] - here.model_sin[i]) / step[at];
      double c = (there.model_cos[i] - here.model_cos[i]) / step[at];
      data.whiten(i, here.model_sin[i], here.model_cos[i], s, c);
      column[static_cast<Eigen::Index>(2 * i)] = s;
      column[static_cast<Eigen::Index>(2 * i + 1)] = c;
    }
    // What each sample moves the estimate by: generalized least squares weighs it against the
    // discrepancy.
    if (data.coloured)
      column = data.coloured->unexplained(column);
    for (Eigen::Index i = 0; i < n; ++i)
      score(k, static_cast<Eigen::Index>(static_cast<std::size_t>(i) * stretches / data.size())) +=
          column[2 * i] * left[2 * i] + column[2 * i + 1] * left[2 * i + 1];
  }
  score.colwise() -= score.rowwise().mean();
  const double variance = result.rss / (2.0 * static_cast<double>(data.size()));
  const Eigen::MatrixXd inverse = result.covariance / std::max(variance, 1e-300);
  const double freedom = static_cast<double>(stretches) / (static_cast<double>(stretches) - 1.0);
  const Eigen::MatrixXd sandwich = freedom * inverse * score * score.transpose() * inverse;
  Eigen::VectorXd wider(parameters);
  for (Eigen::Index k = 0; k < parameters; ++k)
    wider[k] = std::sqrt(std::max(1.0, sandwich(k, k) / std::max(result.covariance(k, k), 1e-300)));
  if (wider.allFinite())
    result.covariance = wider.asDiagonal() * result.covariance * wider.asDiagonal();
}

Model as_seen_by(const Observations &data, Model model) {
  const std::size_t own = data.own_offsets ? 3 : 1;
  const std::array<double Baseline::*, 3> parameter{
      &Baseline::angle_zero_deg, &Baseline::offset_sin_v, &Baseline::offset_cos_v};
  constexpr std::array<double, 3> kStep{1e-3, 1e-4, 1e-4}; // deg, V, V
  for (int pass = 0; pass < 3; ++pass) {
    const ResidualColumns here = residual_columns(data, model);
    std::vector<ResidualColumns> there;
    for (std::size_t k = 0; k < own; ++k) {
      Model moved = model;
      moved.baseline.*parameter[k] += kStep[k];
      there.push_back(residual_columns(data, moved));
    }
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    matrix.topLeftCorner(static_cast<Eigen::Index>(own), static_cast<Eigen::Index>(own)).setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero(), ds = right, dc = right;
    for (std::size_t i = 0; i < data.size(); ++i) {
      double s = here.sin[i], c = here.cos[i];
      data.whiten(i, here.model_sin[i], here.model_cos[i], s, c);
      for (std::size_t k = 0; k < own; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        ds[row] = (there[k].model_sin[i] - here.model_sin[i]) / kStep[k];
        dc[row] = (there[k].model_cos[i] - here.model_cos[i]) / kStep[k];
        data.whiten(i, here.model_sin[i], here.model_cos[i], ds[row], dc[row]);
      }
      matrix += ds * ds.transpose() + dc * dc.transpose();
      right += s * ds + c * dc;
    }
    const Eigen::Vector3d step = solved(matrix, right);
    if (!step.allFinite())
      break;
    for (std::size_t k = 0; k < own; ++k)
      model.baseline.*parameter[k] += step[static_cast<Eigen::Index>(k)];
  }
  return model;
}

void attach_errors(FitResult &result) {
  Model &m = result.model;
  const auto sd = [&](Eigen::Index k) { return std::sqrt(std::max(0.0, result.covariance(k, k))); };
  m.baseline_std_error = {sd(0), sd(1), sd(2), sd(3)};
  std::size_t k = kBaseline;
  for (EffectInstance &e : m.effects) {
    std::vector<double> x = e.effect->to_coordinates(e.values);
    const std::vector<double> h = e.effect->steps(e.values);
    const auto n = static_cast<Eigen::Index>(x.size());
    const auto first = static_cast<Eigen::Index>(k);
    const std::vector<double> centre = e.effect->from_coordinates(e.values, x);
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(centre.size()), n);
    for (Eigen::Index c = 0; c < n; ++c) {
      // A small step against the value's own size: amplitude and phase are curved near zero.
      const auto at = static_cast<std::size_t>(c);
      const double keep = x[at], step = 1e-3 * std::max(std::abs(keep), 1e-3 * h[at]);
      x[at] = keep + step;
      const std::vector<double> moved = e.effect->from_coordinates(e.values, x);
      x[at] = keep;
      for (std::size_t r = 0; r < centre.size(); ++r) {
        double d = moved[r] - centre[r];
        if (e.effect->info().parameters[r].unit == "deg")
          d = wrap_centred(d, 180.0);
        jacobian(static_cast<Eigen::Index>(r), c) = std::isfinite(d) ? d / step : 0.0;
      }
    }
    const Eigen::MatrixXd covariance =
        jacobian * result.covariance.block(first, first, n, n) * jacobian.transpose();
    e.std_errors.resize(centre.size(), 0.0);
    for (std::size_t r = 0; r < centre.size(); ++r) {
      const auto at = static_cast<Eigen::Index>(r);
      // What no fit moves has its error from where it was chosen.
      if (!jacobian.row(at).isZero(0.0)) {
        // A frequency is told in the time of the capture's own clock.
        const double of_clock =
            e.effect->info().parameters[r].unit == "Hz" ? criteria::kClock * centre[r] : 0.0;
        e.std_errors[r] = std::hypot(std::sqrt(std::max(0.0, covariance(at, at))), of_clock);
      }
    }
    k += static_cast<std::size_t>(n);
  }
}

ResidualColumns residual_columns(const Observations &data, const Model &model) {
  ResidualColumns out;
  for (auto *v : {&out.sin, &out.cos, &out.model_sin, &out.model_cos})
    v->resize(data.size());
  const ForwardModel forward(model, AlphaIs::reference);
  const Conditions all = data.conditions();
  for_all_samples(data.size(), [&](std::size_t first, std::size_t n) {
    forward.evaluate(all.slice(first, n), &out.model_sin[first], &out.model_cos[first]);
    for (std::size_t i = first; i < first + n; ++i) {
      out.sin[i] = data.vsin[i] - out.model_sin[i];
      out.cos[i] = data.vcos[i] - out.model_cos[i];
    }
  });
  return out;
}

std::vector<char> where_outputs_pass(const Observations &data, const Model &model) {
  constexpr double kShift = 1e-4, kHalf = 0.5; // V; of it
  Model moved = model;
  moved.baseline.offset_sin_v += kShift;
  moved.baseline.offset_cos_v += kShift;
  const ResidualColumns here = residual_columns(data, model), there = residual_columns(data, moved);
  std::vector<char> out(data.size());
  for (std::size_t i = 0; i < data.size(); ++i)
    out[i] = std::min(there.model_sin[i] - here.model_sin[i],
                      there.model_cos[i] - here.model_cos[i]) > kHalf * kShift;
  return out;
}

double moved_rms_v(const Observations &data, const Model &model, std::size_t effect) {
  const ResidualColumns with = residual_columns(data, model),
                        without = residual_columns(data, model.without(effect));
  double sum = 0.0;
  for (std::size_t i = 0; i < with.sin.size(); ++i) {
    const double s = with.sin[i] - without.sin[i], c = with.cos[i] - without.cos[i];
    sum += s * s + c * c;
  }
  return std::sqrt(sum / (2.0 * static_cast<double>(std::max<std::size_t>(1, with.sin.size()))));
}

ResidualColumns residuals_alone(const Observations &data, const Model &model) {
  ResidualColumns out;
  out.sin.resize(data.size());
  out.cos.resize(data.size());
  const ForwardModel forward(model, AlphaIs::reference);
  const Conditions all = data.conditions();
  for_all_samples(data.size(), [&](std::size_t first, std::size_t n) {
    std::array<double, kWaveBlock> s, c;
    forward.evaluate(all.slice(first, n), s.data(), c.data());
    for (std::size_t i = 0; i < n; ++i) {
      out.sin[first + i] = data.vsin[first + i] - s[i];
      out.cos[first + i] = data.vcos[first + i] - c[i];
    }
  });
  return out;
}

Observations at_own_angle(Observations data, const Model &model) {
  for (int pass = 0; pass < 2; ++pass) {
    const ResidualColumns r = residual_columns(data, model);
    for (std::size_t i = 0; i < data.size(); ++i) {
      // Newton's step to where the model's vector has the direction of the pair. On an ellipse the
      // vector and its derivative span the product of the half axes, wherever it is.
      const Observations::Place at = data.place(r.model_sin[i], r.model_cos[i]);
      const auto &[s, c] = at.vector;
      const auto [near_s, near_c] = data.nearest(data.vsin[i], data.vcos[i]);
      data.alpha[i] +=
          (near_s * c - near_c * s) / (at.long_axis_v * at.short_axis_v) / model.periods_per_turn;
    }
  }
  return data;
}

bool in_range(const EffectInstance &e) {
  const auto parameters = e.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (std::isfinite(e.values[k]) &&
        (e.values[k] < parameters[k].minimum || e.values[k] > parameters[k].maximum))
      return false;
  return true;
}

bool in_range(const Model &model, std::size_t first) {
  return model.baseline.amplitude_v > 0.0 &&
         std::all_of(model.effects.begin() + static_cast<std::ptrdiff_t>(first),
                     model.effects.end(), [](const EffectInstance &e) { return in_range(e); });
}

} // namespace ada
