// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/between_captures.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <utility>
#include <vector>

#include "base/angle.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/criteria.h"
#include "diagnosis/lines/line.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/fit.h"
#include "model/residual.h"
#include "recording/join.h"

namespace ada {

namespace {

/// What the ellipse leaves of one capture, looked at for tones.
class Rest {
public:
  explicit Rest(const Capture &record)
      : record_(record), scene_(prepare_record(record_, false, nullptr)) {
    if (!scene_.insufficient.empty())
      return;
    std::vector<std::uint32_t> every(scene_.all.size());
    std::iota(every.begin(), every.end(), 0u);
    some_ = scene_.all.select(thin(every, criteria::kAnonymousTrain, 100));
    Model model = with_expected(first_model(scene_, nullptr));
    model = fit(some_, model, 10).model;
    left_ = residual_columns(some_, model);
    amplitude_v_ = model.baseline.amplitude_v;
  }

  bool usable() const { return some_.size() >= kFewestForTones; }
  Residual view() const {
    return residual_view(scene_, some_, left_, scene_.white_noise_v, amplitude_v_);
  }
  double span_s() const { return some_.time.back() - some_.time.front(); }

private:
  Capture record_;
  Scene scene_;
  Observations some_;
  ResidualColumns left_;
  double amplitude_v_ = 1.0;
};

/// The frequency at which both have the most, about one that the first has, Hz: each tells it by
/// its own length.
double common_frequency(const Rest &first, const Rest &other, double about_hz) {
  constexpr int kSteps = 32; // either side, of a sixteenth of what the shorter tells apart
  const double step = 1.0 / (16.0 * std::min(first.span_s(), other.span_s()));
  std::vector<double> power(2 * kSteps + 1, 0.0);
  for (const Rest *rest : {&first, &other}) {
    const Residual r = rest->view();
    const double n = static_cast<double>(r.time.size());
    for_each_frequency(r.time, about_hz - kSteps * step, step, 2 * kSteps + 1,
                       [&](int k, const std::vector<double> &s, const std::vector<double> &c) {
                         power[static_cast<std::size_t>(k)] += n * line_of(r, s, c).power;
                       });
  }
  const auto at = std::max_element(power.begin() + 1, power.end() - 1) - power.begin();
  const double *most = &power[static_cast<std::size_t>(at)];
  const double bend = 2.0 * most[0] - most[-1] - most[1]; // the top of the parabola through three
  const double beside = bend > 0.0 ? 0.5 * (most[1] - most[-1]) / bend : 0.0;
  return about_hz + (static_cast<double>(at) - kSteps + std::clamp(beside, -1.0, 1.0)) * step;
}

/// By how long `other` is late for the tone to go on from `first`, s: at least nothing, and less
/// than a period.
double late_by(const Rest &first, const Rest &other, double about_hz) {
  const double hz = common_frequency(first, other, about_hz);
  std::complex<double> turned = 0.0;
  const auto a = line_at(first.view(), hz).amplitudes, b = line_at(other.view(), hz).amplitudes;
  for (std::size_t k : {0u, 2u}) // x sin + y cos is the real part of (y - j x) e^(j w t)
    turned +=
        std::conj(std::complex<double>(a[k + 1], -a[k])) * std::complex<double>(b[k + 1], -b[k]);
  return wrap(std::arg(turned) / kTwoPi, 1.0) / hz;
}

Capture record(const Capture &of, std::size_t k) {
  return of.starts.size() > 1 ? record_of(of, k) : of;
}

/// Moves the records of a capture, from one on.
void move_records(Capture &of, std::size_t from, double by_s) {
  const std::size_t start = of.starts.size() > 1 ? of.starts[from] : 0;
  for (std::size_t i = start; i < of.size(); ++i)
    of.time_s[i] += by_s;
}

std::size_t records_of(const Capture &of) {
  return std::max<std::size_t>(1, of.starts.size());
}

} // namespace

std::optional<InStep> in_step(const Capture &capture, const Capture *heldout) {
  if (records_of(capture) == 1 && !heldout)
    return std::nullopt;
  const Rest first(record(capture, 0));
  if (!first.usable())
    return std::nullopt;
  const auto tones = find_tones(first.view());
  if (tones.empty())
    return std::nullopt;
  const double hz = tones.front().front();
  InStep out{capture, heldout ? std::optional(*heldout) : std::nullopt};
  for (Capture *of : {&out.capture, out.heldout ? &*out.heldout : nullptr})
    for (std::size_t k = of == &out.capture ? 1 : 0; of && k < records_of(*of); ++k)
      if (const Rest other(record(*of, k)); other.usable())
        move_records(*of, k, late_by(first, other, hz));
  return out;
}

} // namespace ada
