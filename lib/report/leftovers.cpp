// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "base/angle.h"
#include "report/page.h"
#include "report/svg.h"
#include "report/words.h"

namespace ada {

namespace {

/// What stands beside a line: two pictures, one, or a sentence below it.
struct Beside {
  const char *columns; ///< class of the box
  std::string html;
};

/// The pictures of one line; `rank` counts the lines before it along the same axis.
Beside pictures_of(const Structure &s, std::size_t rank, const Diagnosis &d, const View &view,
                   Gallery &gallery) {
  if (s.along == axis_name(Axis::frequency)) {
    if (view.spectrum.density.empty())
      return {"", "<p class=\"note\">No picture: a spectrum needs eight stretches of 64 samples "
                  "without a gap.</p>"};
    if (rank > 0)
      return {"", "<p class=\"note\">In the spectrum above.</p>"};
    return {"two", figure(gallery.add(spectrum_picture(view.spectrum, 0, 1, noise_v(d), kBeside)),
                          legend({{"before", html_escape(baseline_words(d))},
                                  {"after", "extended model; band: up to the largest line"},
                                  {"floor dash", "white noise"}}))};
  }
  const std::size_t axis = view.axes.find(s.along);
  if (axis == view.axes.all.size())
    return {"", "<p class=\"note\">No picture: this capture holds no " + html_escape(s.along) +
                    " to draw it against.</p>"};
  return {"two", row({figure(gallery.add(leftover_picture(view, axis, rank)), ""),
                      figure(gallery.add(spread_picture(view, axis)), "")})};
}

std::string reference_speaks(const View &view) {
  const Scene &scene = view.scene;
  if (scene.radius_only)
    return "There is no reference, and the shaft turns unevenly: only its part along the vector is "
           "confirmed, as across it nothing tells the sensor from the motion.";
  if (!scene.has_reference)
    return "There is no reference: it is held against the shaft's own smooth motion, and trusts "
           "that.";
  const std::string trust =
      "It trusts the reference: what the reference itself gets wrong as it turns "
      "is in it, too. ";
  if (scene.reference_ripples.empty())
    return trust +
           "This capture has no steady motion that could speak for or against the reference.";
  const Ripple &once = scene.reference_ripples.front();
  const double ripple = std::hypot(once.cos, once.sin) * kDegPerRad;
  const double error = once.error * kDegPerRad;
  if (ripple > 3.0 * error)
    return trust +
           fmt::format("Against smooth time the reference ripples once a turn by {} \u00b1 {}, "
                       "which speaks against it.",
                       degrees(ripple), degrees(error));
  return trust +
         fmt::format("Against smooth time the reference shows no ripple once a turn above {}, "
                     "which speaks for it.",
                     degrees(3.0 * error));
}

std::string shape_of(const NoiseShape &noise, std::size_t samples) {
  const double n = static_cast<double>(std::max<std::size_t>(1, samples));
  const double ratio = noise.across_v > 0.0 ? noise.along_v / noise.across_v : 1.0;
  // The ratio of two rms values of n samples has a standard error of 1/sqrt(n).
  if (std::abs(std::log(std::max(ratio, 1e-12))) < std::max(0.1, 3.0 / std::sqrt(n)))
    return "It is round: alike along and across the vector, as the noise of the two channels' own "
           "electronics is.";
  return ratio > 1.0
             ? fmt::format("It is {:.2g} times larger along the vector than across it, as the "
                           "noise of a supply or of a gain is.",
                           ratio)
             : fmt::format("It is {:.2g} times larger across the vector than along it, as that "
                           "of vibration, of a reference or of unsteady timing is.",
                           1.0 / ratio);
}

std::string noise_table(const NoiseShape &n, bool radius_only) {
  std::string out =
      "<table><thead><tr><th scope=\"col\">noise</th><th scope=\"col\" class=\"n\">rms</th>"
      "</tr></thead><tbody>";
  std::vector<std::pair<const char *, double>> rows{{"along the vector", n.along_v}};
  if (!radius_only)
    rows = {{"VSIN", n.sin_v}, {"VCOS", n.cos_v}, rows[0], {"across the vector", n.across_v}};
  for (const auto &[name, value] : rows)
    out += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td></tr>", name, millivolts(value));
  return out + "</tbody></table>";
}

} // namespace

std::string left_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  std::string out = "<h2 id=\"left\">What is left over</h2>\n";
  if (d.structure.empty()) {
    std::vector<std::string> cells;
    for (std::size_t a = 0; a < view.axes.all.size(); ++a)
      cells.push_back(figure(gallery.add(leftover_picture(view, a, 0)), ""));
    return out +
           "<p>Nothing but noise: along every axis that this capture has, the extended model "
           "leaves nothing that repeats.</p>\n" +
           row(std::move(cells), "<p class=\"note\">Means of what the extended model leaves, with "
                                 "bars of two standard "
                                 "errors. Noise alone leaves one bar in twenty off zero.</p>");
  }
  std::vector<Structure> lines = d.structure;
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Structure &a, const Structure &b) { return a.rms_v > b.rms_v; });
  out += "<p class=\"note\">Largest first. Left: means of what no cause explains, with bars of two "
         "standard errors; right: by how much the samples scatter about them.</p>\n";
  out += view.scene.radius_only
             ? legend({{"after", "mean"}, {"measured", "scatter along the vector"}})
             : legend({{"after", "mean"},
                       {"measured", "scatter along the vector"},
                       {"second", "scatter across the vector"}});
  const double noise = noise_v(d);
  std::map<std::string, std::size_t> before;
  for (const Structure &s : lines) {
    const Beside beside = pictures_of(s, before[s.along]++, d, view, gallery);
    out += fmt::format(
        "<section class=\"finding left\" data-along=\"{0}\" data-rms-v=\"{1:.6g}\"><div "
        "class=\"{5}\"><div><h3>{2} rms along {0} <span class=\"tag\">{4:.2g} \u00d7 the "
        "noise</span></h3><p>{3}</p></div><div>",
        html_escape(s.along), s.rms_v, millivolts(s.rms_v), html_escape(sentence(s.description)),
        s.rms_v / std::max(noise, 1e-12), beside.columns);
    out += beside.html + "</div></div></section>\n";
  }
  return out;
}

std::string remainder_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  if (!view.remainder)
    return {};
  std::string out = "<h2 id=\"remainder\">periodic-remainder: unnamed</h2>\n<div class=\"two\"><p>";
  out +=
      fmt::format("{} rms, or {} rms of the angle, repeat with the angle, up to order {} of "
                  "the {}, and no known cause "
                  "explains them. The extended model carries them as a table would, and corrects "
                  "them in the angle; they count as no explanation. ",
                  millivolts(d.remainder_rms_v), degrees(view.remainder->angle_rms_deg),
                  d.extended.remainder->orders(),
                  d.extended.remainder->electrical ? "electrical period" : "turn");
  return out + reference_speaks(view) + "</p>\n" +
         figure(
             gallery.add(remainder_picture(view)),
             legend({{"after", "VSIN"},
                     {"second", view.scene.radius_only
                                    ? "VCOS"
                                    : "VCOS (line: the remainder; points: means that it was fitted "
                                      "to, with two standard errors)"}})) +
         "</div>\n";
}

std::string noise_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  std::string out = "<h2 id=\"noise\">The noise</h2>\n";
  const bool radius_only = view.scene.radius_only;
  std::string about =
      "<div><p>What the best model that names nothing leaves, on data that no fit has seen.</p>" +
      noise_table(d.noise, radius_only) + "<p>";
  about += radius_only
               ? "Only the radius was judged: there is no reference, and the shaft turns so "
                 "unevenly that across the vector nothing tells noise from motion."
               : shape_of(d.noise, view.scatter.along.size());
  if (!d.by_reference() && !radius_only)
    about += " Without a reference the angle comes from the pair itself, so that part of what lies "
             "across the vector is taken for motion.";
  about += "</p></div>";
  if (radius_only)
    return out + row({about, figure(gallery.add(histogram_picture(view.scatter, true)),
                                    legend({{"measured dot", "along the vector"},
                                            {"floor dash", "normal distribution"}}))});
  return out +
         row({about,
              figure(gallery.add(scatter_picture(view.scatter, d.noise)),
                     legend({{"measured dot", "what the extended model leaves of single samples"},
                             {"floor", "two standard deviations of the noise"}})),
              figure(gallery.add(histogram_picture(view.scatter, false)),
                     legend({{"measured dot", "along"},
                             {"second ring", "across"},
                             {"floor dash", "normal distribution"}}))});
}

} // namespace ada
