// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/borne_out.h"

#include <algorithm>
#include <complex>
#include <numeric>
#include <optional>

#include "base/angle.h"
#include "base/products.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/admission.h"

namespace ada {

namespace {

/// Both channels of each sample in one vector.
template <class T> Eigen::VectorXd stacked(const std::vector<T> &sin, const std::vector<T> &cos) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(2 * sin.size()));
  for (std::size_t i = 0; i < sin.size(); ++i) {
    out[static_cast<Eigen::Index>(2 * i)] = sin[i];
    out[static_cast<Eigen::Index>(2 * i + 1)] = cos[i];
  }
  return out;
}

Eigen::VectorXd signal(const Observations &data, const Model &model) {
  const ResidualColumns r = residual_columns(data, model);
  return stacked(r.model_sin, r.model_cos);
}

/// The order m of the strongest term c e^(j m x) of a signal, c complex and x the angle of the
/// turn, but for the offsets and the vector itself, which every model has.
int strongest_order(const Observations &data, int periods, const Eigen::VectorXd &left) {
  const int highest = (criteria::kNamedPeriods + 1) * periods,
            step = periods <= criteria::kMostPeriodsInTurns ? 1 : periods;
  double most = 0.0;
  int order = 2 * periods;
  for (int m = -highest; m <= highest; m += step) {
    if (m == 0 || m == periods)
      continue;
    std::complex<double> sum;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(2 * i);
      sum += std::complex<double>(left[at + 1], left[at]) * std::polar(1.0, -m * data.alpha[i]);
    }
    if (std::norm(sum) > most) {
      most = std::norm(sum);
      order = m;
    }
  }
  return order;
}

/// Rows of real and imaginary c of such a term.
Eigen::MatrixXd term(const Observations &data, int order) {
  Eigen::MatrixXd out(2, static_cast<Eigen::Index>(2 * data.size()));
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::complex<double> z = std::polar(1.0, order * data.alpha[i]);
    const auto sin = static_cast<Eigen::Index>(2 * i), cos = sin + 1;
    out(0, sin) = z.imag();
    out(0, cos) = z.real();
    out(1, sin) = z.real();
    out(1, cos) = -z.imag();
  }
  return out;
}

/// Least squares of a signal on rows: its coefficients.
Eigen::VectorXd coefficients(const Eigen::MatrixXd &rows, const Eigen::VectorXd &of) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
  add_squares(rows, gram);
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * solved(scale.asDiagonal() * gram * scale.asDiagonal(),
                                     scale.asDiagonal() * (rows * of).eval());
}

} // namespace

void widen_by_what_is_not_borne_out(const Observations &all, FitResult &result) {
  constexpr std::size_t kEnough = 4000; // a shape is known by fewer than its size is
  constexpr double kAsLikely = 0.5;     // of either reading
  std::vector<std::uint32_t> indices(all.size());
  std::iota(indices.begin(), indices.end(), 0u);
  const Observations data = all.select(thin(indices, kEnough, 100));
  const Model &model = result.model;
  const std::vector<double> x = coordinates_of(model), step = coordinate_steps(model);
  const auto parameters = static_cast<Eigen::Index>(x.size());
  const double variance = result.rss / (2.0 * static_cast<double>(all.size()));
  const double samples_each = static_cast<double>(all.size()) / static_cast<double>(data.size());
  std::optional<Eigen::MatrixXd> columns; // made when a cause asks for them
  Eigen::VectorXd here, left;
  const auto prepare = [&] {
    here = signal(data, model);
    left = stacked(data.vsin, data.vcos) - here;
    columns.emplace(parameters, here.size());
    std::vector<double> moved = x;
    for (Eigen::Index k = 0; k < parameters; ++k) {
      const auto at = static_cast<std::size_t>(k);
      moved[at] = x[at] + step[at];
      columns->row(k) =
          ((signal(data, with_coordinates(model, moved)) - here) / step[at]).transpose();
      moved[at] = x[at];
    }
  };
  Eigen::MatrixXd wider = Eigen::MatrixXd::Zero(parameters, parameters);
  // Products of causes are not known to second order: which of two stages acts first.
  double at_rest = std::hypot(model.baseline.offset_sin_v, model.baseline.offset_cos_v);
  for (std::size_t e = 0; e < model.effects.size(); ++e)
    if (of_the_angle(*model.effects[e].effect))
      at_rest += moved_rms_v(data, model, e);
  auto first = static_cast<Eigen::Index>(coordinates_of(Model{}).size());
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    const EffectInfo &info = model.effects[e].effect->info();
    const auto own = static_cast<Eigen::Index>(
        model.effects[e].effect->to_coordinates(model.effects[e].values).size());
    const Eigen::Index from = first;
    first += own;
    if (info.prior_rank == 0 || info.evidence != Evidence::signal || own < 2 ||
        shows_beyond_angle(*model.effects[e].effect) || info.stage == Stage::motion)
      continue;
    if (!columns)
      prepare();
    const Eigen::VectorXd shape = here - signal(data, model.without(e));
    std::vector<Eigen::Index> others;
    for (Eigen::Index k = 0; k < parameters; ++k)
      if (k < from || k >= first)
        others.push_back(k);
    const auto m = static_cast<Eigen::Index>(others.size());
    // What the others take of it beside as many free numbers, and what neither holds.
    Eigen::MatrixXd rows = (*columns)(others, Eigen::all);
    Eigen::VectorXd move = coefficients(rows, shape), alone = shape - rows.transpose() * move;
    for (Eigen::Index k = 0; k + 1 < own; k += 2) {
      const int order = strongest_order(data, model.periods_per_turn, alone);
      const Eigen::MatrixXd more = term(data, order);
      rows.conservativeResize(rows.rows() + 2, Eigen::NoChange);
      rows.bottomRows(2) = more;
      move = coefficients(rows, shape);
      alone = shape - rows.transpose() * move;
    }
    // By how much the data then are less likely.
    const double nats =
        samples_each * (2.0 * alone.dot(left) + alone.squaredNorm()) / (2.0 * variance);
    const double size = std::sqrt(shape.squaredNorm()), beyond = std::sqrt(alone.squaredNorm());
    const double blurred = std::min(criteria::kMostBlurred,
                                    criteria::kSecondOrder * at_rest / model.baseline.amplitude_v);
    if (!move.allFinite() || (nats > criteria::kRivalNats && beyond > blurred * size))
      continue;
    for (Eigen::Index a = 0; a < m; ++a)
      for (Eigen::Index b = 0; b < m; ++b)
        wider(others[static_cast<std::size_t>(a)], others[static_cast<std::size_t>(b)]) +=
            kAsLikely * move[a] * move[b];
  }
  if (wider.allFinite())
    result.covariance += wider;
}

} // namespace ada
