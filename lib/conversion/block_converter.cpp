// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/block_converter.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/error.h"
#include "conversion/sample_status.h"

namespace ada {

namespace {

ada4571_layout packed_doubles() {
  return {sizeof(ada4571_layout), ADA4571_F64, sizeof(double), 1.0, 0.0, 0, 0};
}

/// The vector kernels, where the model is one for them.
std::optional<RawConverter> raw_converter(const Model &model) {
  try {
    return RawConverter(model);
  } catch (const Error &e) {
    if (e.status() != ADA4571_ERROR_UNSUPPORTED)
      throw;
    return std::nullopt;
  }
}

template <class Visit>
void for_those_in(const std::vector<std::size_t> &samples, const Block &block, Visit visit) {
  for (auto i = std::lower_bound(samples.begin(), samples.end(), block.first);
       i != samples.end() && *i < block.first + block.count; ++i)
    visit(*i - block.first);
}

} // namespace

void AngleBlock::resize(std::size_t count) {
  angle_deg.resize(count);
  radius.resize(count);
  status.resize(count);
}

void AngleBlock::set(std::size_t i, const ada4571_angle &angle) {
  angle_deg[i] = angle.angle_deg;
  radius[i] = angle.radius;
  status[i] = angle.status;
}

BlockConverter::BlockConverter(const Model &model, const Recording &recording)
    : recording_(recording), model_(model_for(model, recording.meta(), recording.channels())),
      frames_(model_), raw_(raw_converter(model_)) {
  if (!raw_ && !frames_.sample_by_sample()) {
    all_.resize(recording.size());
    frames_.capture(*recording.whole(), all_);
  }
}

void BlockConverter::convert(std::size_t k, AngleBlock &out, bool times) const {
  if (const auto pairs = raw_ ? recording_.raw_pairs(k) : std::nullopt) {
    recording_.read(k, times ? kTimeColumn : 0, out.block);
    out.resize(out.count());
    by_kernel(*pairs, out);
    mark_gaps(out);
    return;
  }
  recording_.read(k, columns(times), out.block);
  convert(out);
}

void BlockConverter::convert(AngleBlock &out) const {
  out.resize(out.count());
  if (raw_)
    by_kernel(out);
  else if (all_.empty())
    by_frames(out);
  else
    for (std::size_t i = 0; i < out.count(); ++i)
      out.set(i, all_[out.block.first + i]);
  mark_gaps(out);
}

SampleLimits BlockConverter::limits(const ada4571_layout &layout) const {
  const Rails rails(model_.supply_v);
  return {kDegPerRad,    std::nextafter(360.0 / model_.periods_per_turn, 0.0),
          kRadiusMin,    kRadiusMax,
          layout.offset, layout.scale_v,
          rails.low_v,   rails.high_v};
}

void BlockConverter::by_kernel(AngleBlock &out) const {
  const Block &in = out.block;
  const ada4571_layout layout = packed_doubles();
  const double *sin = in.vsin_v.data(), *cos = in.vcos_v.data();
  raw_->convert(layout, sin, cos, in.count, out.angle_deg.data(), out.radius.data());
  if (!finish_planar_f64(sin, cos, in.count, limits(layout), out.angle_deg.data(),
                         out.radius.data(), out.status.data()))
    convert_singly(in, out);
}

void BlockConverter::by_kernel(const RawPairs &in, AngleBlock &out) const {
  raw_->convert(in.layout, in.sin(), in.cos(), out.count(), out.angle_deg.data(),
                out.radius.data());
  const auto finish = in.layout.type == ADA4571_S16 ? finish_pairs_i16 : finish_pairs_u16;
  if (finish(in.data(), out.count(), limits(in.layout), out.angle_deg.data(), out.radius.data(),
             out.status.data()))
    return;
  Block volts;
  recording_.read(recording_.block_of(out.block.first), kPairColumns, volts);
  convert_singly(volts, out);
}

/// What the kernels make no numbers of.
void BlockConverter::convert_singly(const Block &in, AngleBlock &out) const {
  for (std::size_t i = 0; i < in.count; ++i)
    if (!std::isfinite(out.radius[i]) || out.radius[i] == 0)
      out.set(i, frames_.sample(frame_at(in, i)));
}

void BlockConverter::by_frames(AngleBlock &out) const {
  double vtemp_v = kAbsent;
  for (std::size_t i = 0; i < out.count(); ++i)
    out.set(i, frames_.sample(frame_at(out.block, i), vtemp_v));
}

void BlockConverter::mark_gaps(AngleBlock &out) const {
  const auto mark = [&](std::size_t i) { out.status[i] |= ADA4571_SAMPLE_GAP; };
  for_those_in(recording_.jumps(), out.block, mark);
  for_those_in(recording_.facts().gaps, out.block, mark);
}

} // namespace ada
