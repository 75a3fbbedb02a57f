// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/column_sums.h"

#include <algorithm>
#include <array>

#include "base/products.h"
#include "diagnosis/over_samples.h"

namespace ada {

namespace {

/// Functions from which on all that was kept is given up: lines of the spectrum, and steps, come
/// anew with each question.
constexpr std::size_t kMostKept = 400;

struct NewSums {
  Eigen::VectorXcd plain;
  Eigen::MatrixXd mixed_cos, mixed_sin;
  std::map<int, std::pair<Eigen::MatrixXd, Eigen::MatrixXd>> between; ///< cosine and sine
  NewSums &operator+=(const NewSums &other) {
    plain += other.plain;
    mixed_cos += other.mixed_cos;
    mixed_sin += other.mixed_sin;
    for (auto &[k, sums] : between) {
      sums.first += other.between.at(k).first;
      sums.second += other.between.at(k).second;
    }
    return *this;
  }
};

/// What the functions of a basis look at.
Observations seen(const Observations &data) {
  Observations out;
  out.time = data.time;
  out.alpha = data.alpha;
  out.omega = data.omega;
  out.direction = data.direction;
  out.temp = data.temp;
  out.supply = data.supply;
  return out;
}

bool same(const Observations &a, const Observations &b) {
  return a.time == b.time && a.alpha == b.alpha && a.omega == b.omega &&
         a.direction == b.direction && a.temp == b.temp && a.supply == b.supply;
}

} // namespace

void powers(const Eigen::Ref<const Eigen::VectorXd> &angles, Eigen::Ref<Eigen::MatrixXd> cosine,
            Eigen::Ref<Eigen::MatrixXd> sine) {
  // Several angles at a time: each power waits for the one before it.
  constexpr Eigen::Index kTogether = 8;
  for (Eigen::Index first = 0; first < angles.size(); first += kTogether) {
    const Eigen::Index n = std::min(kTogether, angles.size() - first);
    std::array<double, kTogether> x{}, y{}, c{}, s{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      const auto unit = std::polar(1.0, angles[first + static_cast<Eigen::Index>(i)]);
      x[i] = unit.real();
      y[i] = unit.imag();
      c[i] = 1.0;
    }
    for (Eigen::Index k = 0; k < cosine.rows(); ++k) {
      for (Eigen::Index i = 0; i < n; ++i) {
        cosine(k, first + i) = c[static_cast<std::size_t>(i)];
        sine(k, first + i) = s[static_cast<std::size_t>(i)];
      }
      for (std::size_t i = 0; i < kTogether; ++i) {
        const double next = c[i] * x[i] - s[i] * y[i];
        s[i] = c[i] * y[i] + s[i] * x[i];
        c[i] = next;
      }
    }
  }
}

std::size_t ColumnSums::place_of(const Modulation &function) const {
  return static_cast<std::size_t>(std::find(functions_.begin(), functions_.end(), function) -
                                  functions_.begin());
}

bool ColumnSums::serves(const Needed &needed) const {
  return unit_ == needed.unit && needed.plain < plain_.size() && needed.mixed < mixed_.cols() &&
         functions_.size() + needed.functions.size() <= kMostKept &&
         std::all_of(needed.pairs.begin(), needed.pairs.end(),
                     [&](int k) { return between_.contains(k); }) &&
         scale_.scaled_as(needed.basis) && same(samples_, needed.data);
}

void ColumnSums::begin(const Needed &needed) {
  *this = {};
  samples_ = seen(needed.data);
  scale_ = needed.basis;
  unit_ = needed.unit;
  values_.resize(0, static_cast<Eigen::Index>(needed.data.size()));
  plain_ = Eigen::VectorXcd::Zero(needed.plain + 1);
  mixed_ = Eigen::MatrixXcd::Zero(0, needed.mixed + 1);
  for (int k : needed.pairs)
    between_[k] = Eigen::MatrixXcd::Zero(0, 0);
}

void ColumnSums::need(const Needed &needed) {
  const bool anew = !serves(needed);
  if (anew)
    begin(needed);
  std::vector<Modulation> more;
  for (const Modulation &f : needed.functions)
    if (place_of(f) == functions_.size() && std::find(more.begin(), more.end(), f) == more.end())
      more.push_back(f);
  if (anew || !more.empty())
    add(more, needed);
}

void ColumnSums::add(const std::vector<Modulation> &functions, const Needed &needed) {
  const auto before = static_cast<Eigen::Index>(functions_.size()),
             more = static_cast<Eigen::Index>(functions.size()), all = before + more;
  const Observations &data = needed.data;
  functions_.insert(functions_.end(), functions.begin(), functions.end());
  values_.conservativeResize(all, Eigen::NoChange);
  for_all_samples(data.size(), [&](std::size_t first, std::size_t n) {
    for (std::size_t i = first; i < first + n; ++i)
      for (Eigen::Index f = 0; f < more; ++f)
        values_(before + f, static_cast<Eigen::Index>(i)) =
            needed.basis.function(functions[static_cast<std::size_t>(f)], data, i);
  });
  const Eigen::Index spans = std::max<Eigen::Index>(
      {plain_.size(), mixed_.cols(), between_.empty() ? 0 : between_.rbegin()->first + 1});
  NewSums zero{Eigen::VectorXcd::Zero(plain_.size()),
               Eigen::MatrixXd::Zero(more, mixed_.cols()),
               Eigen::MatrixXd::Zero(more, mixed_.cols()),
               {}};
  if (more > 0)
    for (const auto &[k, sum] : between_)
      zero.between[k] = {Eigen::MatrixXd::Zero(more, all), Eigen::MatrixXd::Zero(more, all)};
  const Eigen::Map<const Eigen::VectorXd> angles(data.alpha.data(),
                                                 static_cast<Eigen::Index>(data.size()));
  const auto add_block = [&](NewSums &sums, std::size_t first, std::size_t n) {
    const auto at = static_cast<Eigen::Index>(first), samples = static_cast<Eigen::Index>(n);
    Eigen::MatrixXd cosine(spans, samples), sine(spans, samples);
    powers(unit_ * angles.segment(at, samples), cosine, sine);
    for (Eigen::Index k = 0; k < plain_.size(); ++k)
      sums.plain[k] += Complex(cosine.row(k).sum(), sine.row(k).sum());
    if (more == 0)
      return;
    const Eigen::MatrixXd fresh = values_.block(before, at, more, samples),
                          both = values_.block(0, at, all, samples);
    add_products(fresh, cosine.topRows(mixed_.cols()), sums.mixed_cos);
    add_products(fresh, sine.topRows(mixed_.cols()), sums.mixed_sin);
    for (auto &[k, of] : sums.between) {
      add_products(fresh * cosine.row(k).asDiagonal(), both, of.first);
      if (k > 0)
        add_products(fresh * sine.row(k).asDiagonal(), both, of.second);
    }
  };
  const NewSums sums = sum_over(data.size(), zero, add_block);
  plain_ = sums.plain;
  mixed_.conservativeResize(all, Eigen::NoChange);
  mixed_.bottomRows(more).real() = sums.mixed_cos;
  mixed_.bottomRows(more).imag() = sums.mixed_sin;
  for (auto &[k, sum] : between_) {
    sum.conservativeResize(all, all);
    if (more == 0)
      continue;
    sum.bottomRows(more).real() = sums.between.at(k).first;
    sum.bottomRows(more).imag() = sums.between.at(k).second;
    sum.topRightCorner(before, more) = sum.bottomLeftCorner(more, before).transpose();
  }
}

} // namespace ada
