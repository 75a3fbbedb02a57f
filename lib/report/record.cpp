// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/record.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "diagnosis/search/fit.h"
#include "report/axes.h"

namespace ada {

namespace {

constexpr std::size_t kStretches = 300, kChunk = 65536, kNeighbours = 75;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr Extremes kNone{kInfinite, -kInfinite, kInfinite, -kInfinite};

void take(Extremes &e, double sin_v, double cos_v) {
  e.sin_low = std::min(e.sin_low, 1e3 * sin_v);
  e.sin_high = std::max(e.sin_high, 1e3 * sin_v);
  e.cos_low = std::min(e.cos_low, 1e3 * cos_v);
  e.cos_high = std::max(e.cos_high, 1e3 * cos_v);
}

/// Part by part: a long capture has no memory to spare.
template <class Each> void in_chunks(const Observations &data, const Each &each) {
  std::vector<std::uint32_t> index;
  for (std::size_t first = 0; first < data.size(); first += kChunk) {
    index.resize(std::min(kChunk, data.size() - first));
    std::iota(index.begin(), index.end(), static_cast<std::uint32_t>(first));
    each(data.select(index));
  }
}

class Maker {
public:
  Maker(const Scene &scene, const Model &model)
      : sets_{&scene.all, &scene.spiked, &scene.rough, &scene.bursts}, scene_(scene), model_(model),
        stretches_(kStretches, kNone) {
    out_.start_s = scene.all.time.front();
    double end = out_.start_s;
    for (const Observations *data : sets_)
      if (data->size() > 0) {
        out_.start_s = std::min(out_.start_s, data->time.front());
        end = std::max(end, data->time.back());
      }
    per_second_ = end > out_.start_s ? kStretches / (end - out_.start_s) : 0.0;
  }

  Record make() {
    for (const Observations *data : sets_)
      in_chunks(*data, [this](const Observations &part) { add(part); });
    for (std::size_t k = 0; k < kStretches; ++k) {
      if (!(stretches_[k].sin_low <= stretches_[k].sin_high))
        continue;
      out_.time_s.push_back(per_second_ > 0.0 ? (static_cast<double>(k) + 0.5) / per_second_ : 0.0);
      out_.extremes.push_back(stretches_[k]);
    }
    look_near();
    return std::move(out_);
  }

private:
  void add(const Observations &part) {
    const ResidualColumns left = shown_residual(scene_, part, model_);
    out_.shown += part.size();
    for (std::size_t i = 0; i < part.size(); ++i) {
      const double at = (part.time[i] - out_.start_s) * per_second_;
      const auto k = std::min(kStretches - 1, static_cast<std::size_t>(std::max(at, 0.0)));
      take(stretches_[k], left.sin[i], left.cos[i]);
      const double s = std::abs(left.sin[i]), c = std::abs(left.cos[i]);
      if (std::max(s, c) > out_.worst_v) {
        out_.worst_v = std::max(s, c);
        out_.worst_in_sin = s >= c;
        out_.worst_s = part.time[i];
      }
    }
  }

  /// The samples on both sides of the worst one, whatever set they are in.
  void look_near() {
    std::vector<std::array<double, 3>> rows;
    for (const Observations *data : sets_) {
      const auto at = static_cast<std::size_t>(
          std::lower_bound(data->time.begin(), data->time.end(), out_.worst_s) -
          data->time.begin());
      std::vector<std::uint32_t> index;
      for (std::size_t i = at < kNeighbours ? 0 : at - kNeighbours;
           i < std::min(data->size(), at + kNeighbours + 1); ++i)
        index.push_back(static_cast<std::uint32_t>(i));
      const Observations part = data->select(index);
      const ResidualColumns left = shown_residual(scene_, part, model_);
      for (std::size_t i = 0; i < part.size(); ++i)
        rows.push_back({part.time[i] - out_.worst_s, 1e3 * left.sin[i], 1e3 * left.cos[i]});
    }
    std::sort(rows.begin(), rows.end(),
              [](const auto &a, const auto &b) { return std::abs(a[0]) < std::abs(b[0]); });
    rows.resize(std::min(rows.size(), 2 * kNeighbours + 1));
    std::sort(rows.begin(), rows.end());
    for (const auto &row : rows) {
      out_.near_s.push_back(row[0]);
      out_.near_sin.push_back(row[1]);
      out_.near_cos.push_back(row[2]);
    }
  }

  std::array<const Observations *, 4> sets_;
  const Scene &scene_;
  const Model &model_;
  std::vector<Extremes> stretches_;
  double per_second_ = 0.0;
  Record out_;
};

} // namespace

Record record_of(const Scene &scene, const Model &extended) {
  return Maker(scene, extended).make();
}

} // namespace ada
