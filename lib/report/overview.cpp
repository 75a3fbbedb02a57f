// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "report/page.h"
#include "report/svg.h"
#include "report/words.h"

namespace ada {

namespace {

constexpr std::size_t kMostSteps = 24;

std::string base_name(const Diagnosis &d) {
  return html_escape(baseline_words(d));
}

} // namespace

std::string record_section(const Diagnosis &d, const Capture &capture, const View &view,
                           Gallery &gallery) {
  const Record &r = view.record;
  // Expected largest of n normal values, to first order.
  const double n = 2.0 * static_cast<double>(std::max<std::size_t>(2, r.shown));
  const double expected_v = noise_v(d) * std::sqrt(2.0 * std::log(n));
  std::string text = fmt::format(
      "<p>Every sample counts here, also those that no fit has used. The largest deviation "
      "from the extended model is {} of {}, {:.6g} s after the start. Normal noise alone "
      "reaches about {} in so many samples: a rare or a slow disturbance stands out of the "
      "dashed lines.",
      millivolts(r.worst_v), r.worst_in_sin ? "VSIN" : "VCOS", r.worst_s - r.start_s,
      millivolts(expected_v));
  if (r.shown < capture.size())
    text += fmt::format(" {} of {} samples are not shown: their angle is not known well enough.",
                        capture.size() - r.shown, capture.size());
  return "<h2 id=\"record\">The record over time, sample by sample</h2>\n" +
         halves({figure(gallery.add(envelope_picture(r, true, expected_v)), ""),
                 figure(gallery.add(envelope_picture(r, false, expected_v)), ""),
                 figure(gallery.add(worst_picture(r)),
                        legend({{"after dot", "VSIN"}, {"second ring", "VCOS"}}))},
                text + "</p>" +
                    legend({{"box after", "least to largest, measured minus extended model"},
                            {"floor dash", "as far as normal noise reaches"}}));
}

std::string measured_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  const double amplitude = d.extended.baseline.amplitude_v, factor = locus_factor(view, amplitude);
  std::string out = "<h2>Measured against simulated</h2>\n<div class=\"row wide\">";
  out += figure(gallery.add(stretch_picture(view, d.periods_per_turn)) +
                    gallery.add(stretch_residual_picture(view, true)) +
                    gallery.add(stretch_residual_picture(view, false)),
                legend({{"pale thick", "measured"},
                        {"after", "VSIN of the extended model, and what it leaves"},
                        {"after dash", "VCOS of it"},
                        {"before", "what " + base_name(d) + " leaves"}}));
  out +=
      figure(gallery.add(locus_picture(view, factor, amplitude)),
             legend({{"pale thick", "ideal circle, of " + base_name(d)},
                     {"before", fmt::format("measured minus ideal, \u00d7{:g}", factor)},
                     {"after", fmt::format("measured minus extended model, \u00d7{:g}", factor)}}));
  return out + "</div>\n";
}

std::string residual_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  const double limit = residual_limit(view.baseline, view.final);
  const std::size_t n = view.axes.all.size();
  std::vector<std::string> cells;
  for (std::size_t a = 0; a < n; ++a)
    cells.push_back(figure(gallery.add(residual_picture(view.axes, a, view.baseline, view.final,
                                                        limit, n < 3 ? kHalf : kPanel)),
                           ""));
  return "<h2>Residual before and after</h2>\n" + row(std::move(cells)) +
         legend({{"before", "measured minus " + base_name(d)},
                 {"after", "measured minus extended model"}}) +
         "<p class=\"note\">Line: mean over each bin; band or bar: its spread, one standard "
         "deviation. One "
         "scale for all. Each panel shows the part that changes most: one of the outputs, along "
         "the vector "
         "(its radius), or across it (which turns the angle).</p>\n";
}

std::string nested_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  std::vector<NestedStep> steps{{d.baseline_name.substr(0, 40), d.baseline_quality}};
  // What was seen before any model was fitted is a step only where leaving its samples out gains.
  const auto gains = [](const Finding &f) {
    return f.effect->info().evidence != Evidence::screening ||
           f.after.heldout.residual_rms_v < f.before.heldout.residual_rms_v;
  };
  for (const Finding &f : d.findings)
    if (steps.size() < kMostSteps && gains(f))
      steps.push_back({"+ " + std::string(f.effect->info().id), f.after});
  if (d.extended.remainder && steps.size() < kMostSteps)
    steps.push_back({"+ unnamed remainder", d.extended_quality});
  std::vector<std::string> cells;
  if (steps.size() > 1) {
    cells.push_back(figure(gallery.add(nested_picture(steps, noise_v(d), false)),
                           legend({{"after dot", "held out: data that no fit has seen"},
                                   {"muted ring", "in sample"},
                                   {"floor dash", "the noise"}})));
    if (d.baseline_quality.heldout.angle_error_rms_deg)
      cells.push_back(figure(gallery.add(nested_picture(steps, noise_v(d), true)),
                             legend({{"after dot", "held out"}, {"muted ring", "in sample"}})));
  }
  if (!view.base_angle_error.empty())
    cells.push_back(
        figure(gallery.add(angle_error_picture(view, d.baseline_name)),
               legend({{"before", base_name(d)}, {"after", "extended model: mean and spread"}})));
  if (!view.spectrum.density.empty())
    cells.push_back(figure(gallery.add(spectrum_picture(view.spectrum, 0, 1, noise_v(d), kHalf)),
                           legend({{"before", base_name(d)},
                                   {"after", "extended model; band: up to the largest line"},
                                   {"floor dash", "white noise"}})));
  if (cells.empty())
    return {};
  return "<h2>What each step gains</h2>\n" +
         halves(std::move(cells), "<p class=\"note\">Every cause is added to those above it, and "
                                  "judged on data that no fit has "
                                  "seen; the last step is the extended model.</p>");
}

} // namespace ada
