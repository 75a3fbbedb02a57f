// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/recording_to_fit.h"

#include "base/error.h"
#include "base/parallel.h"
#include "recording/spread_sample.h"

namespace ada {

namespace {

/// Electrical degrees of the circle that a sample must show to stand for the recording.
constexpr double kWellCoveredDeg = 270;

/// Pairs of one block.
struct Picked {
  Block block;
  Pairs pairs;
};

} // namespace

void Pairs::append(const Pairs &next) {
  vsin_v.insert(vsin_v.end(), next.vsin_v.begin(), next.vsin_v.end());
  vcos_v.insert(vcos_v.end(), next.vcos_v.begin(), next.vcos_v.end());
}

void pick_pairs(const Block &block, std::size_t samples, std::size_t parts, Pairs &out) {
  out.vsin_v.clear();
  out.vcos_v.clear();
  const std::size_t begin = block.first, end = begin + block.count, length = samples / parts;
  for (std::size_t n = begin / length; n < parts && n * length < end; ++n) {
    const std::size_t place = sample_place(samples, parts, 1, n);
    if (place < begin || place >= end)
      continue;
    out.vsin_v.push_back(block.vsin_v[place - begin]);
    out.vcos_v.push_back(block.vcos_v[place - begin]);
  }
}

const Pairs &RecordingToFit::scattered() const {
  if (pairs.vsin_v.empty())
    in_order<Picked>(
        recording.blocks(),
        [this](std::size_t k, Picked &p) {
          recording.read(k, kPairColumns, p.block);
          pick_pairs(p.block, recording.size(), kFirstSample, p.pairs);
        },
        [this](std::size_t, const Picked &p) { pairs.append(p.pairs); });
  return pairs;
}

EllipseFit fit_ellipse_to_sample(const RecordingToFit &what, const EllipseFitOptions &options) {
  try {
    EllipseFit fit = fit_ellipse(what.sample->vsin_v, what.sample->vcos_v, options);
    if (!what.is_long || fit.coverage_deg >= kWellCoveredDeg)
      return fit;
  } catch (const Error &) {
    if (!what.is_long)
      throw;
  }
  return fit_ellipse(what.scattered().vsin_v, what.scattered().vcos_v, options);
}

RecordingToFit::RecordingToFit(const Recording &all, bool whole)
    : recording(all), is_long(!whole && all.size() > kFittedWhole),
      sample(is_long ? spread_sample(all, kFirstSample, kFirstStretch) : all.whole()) {}

std::size_t RecordingToFit::place(std::size_t of_sample) const {
  return is_long ? sample_place(recording.size(), kFirstSample, kFirstStretch, of_sample)
                 : of_sample;
}

} // namespace ada
