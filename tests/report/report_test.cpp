// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/report.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

#include "report/count.h"
#include "report/samples.h"
#include "report/view.h"
#include "report/words.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada {
namespace {

constexpr const char *kEvil = "<script>alert(1)</script>\"'&\n`touch x`";

/// What stands between `open` and `close`, each time that `open` is there.
std::vector<std::string> each(const std::string &text, const std::string &open,
                              const std::string &close) {
  std::vector<std::string> out;
  for (std::size_t at = text.find(open); at != text.npos; at = text.find(open, at)) {
    at += open.size();
    out.push_back(text.substr(at, text.find(close, at) - at));
  }
  return out;
}

class Report : public ::testing::Test {
protected:
  std::string page(const Capture &capture, const Diagnosis &diagnosis) {
    const std::string path = folder_ / "report.html";
    write_report(diagnosis, capture, path);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"report.html"});
    return test::read_file(path);
  }
  test::TempFolder folder_;
};

TEST_F(Report, ShowsEveryFindingOnABoundedPage) {
  const Capture capture =
      test::capture_with({"amplitude-mismatch:k=0.02", "stray-field:b=0.01",
                          "offset-temperature-drift", "quadrature-error", "channel-skew"},
                         true, test::fresh_seed());
  const Diagnosis d = diagnose(capture, {});
  ASSERT_GE(d.findings.size(), 3u);
  const std::string text = page(capture, d);
  EXPECT_LT(text.size(), 1500000u);
  for (std::size_t i = 0; i < d.findings.size(); ++i) {
    const Finding &f = d.findings[i];
    const std::string name(f.effect->info().id), number = std::to_string(i + 1);
    const std::string card =
        each(text, "id=\"finding-" + number + "\" data-cause=\"", "</section>")[0];
    EXPECT_TRUE(card.starts_with(name));
    // A curve, or the reason why there is none.
    EXPECT_TRUE(card.find("<svg") != card.npos || card.find("No curve") != card.npos) << name;
    // All numbers, under the names that commands take, in the table of all causes, too.
    const std::string row =
        each(text, "<a href=\"#finding-" + number + "\">" + name + "</a></td>", "</tr>")[0];
    for (std::size_t k = 0; k < f.values.size(); ++k)
      if (!std::isnan(f.values[k])) {
        const std::string parameter = "<code>" + std::string(f.effect->info().parameters[k].name);
        EXPECT_NE(row.find(parameter), row.npos) << name << parameter;
        EXPECT_NE(card.find(parameter), card.npos) << name << parameter;
      }
  }
  EXPECT_EQ(count(text, "<svg"), count(text, "</svg>"));
  EXPECT_EQ(count(text, "<svg") - 1, count(text, "role=\"img\" aria-label=\""));
  EXPECT_EQ(text.find_first_of("\x01\x02"), text.npos);
  EXPECT_EQ(text.find("class=\"undrawn\""), text.npos);
}

TEST_F(Report, BeginsWithTheBudgetThenCausesThenWhatIsLeft) {
  const Capture capture = test::capture_with(
      {"amplitude-mismatch:k=0.02", "offset-temperature-drift"}, true, test::fresh_seed());
  const Diagnosis d = diagnose(capture, {});
  const std::string text = page(capture, d);
  std::size_t at = 0;
  for (const char *mark : {"id=\"verdict\"", "id=\"budget\"", "id=\"causes\"", "id=\"finding-1\"",
                           "id=\"left\"", "id=\"noise\"", "id=\"record\"", "id=\"model\""}) {
    EXPECT_EQ(count(text, mark), 1u) << mark;
    EXPECT_GT(text.find(mark), at) << mark;
    at = text.find(mark);
  }
  // Every line of the budget, the largest first, and the noise for comparison at the end.
  const std::vector<std::string> axes = each(text, "data-axis=\"", "\"");
  ASSERT_EQ(axes.size(), d.budget.size());
  EXPECT_EQ(axes.back(), "noise");
  double before = INFINITY;
  for (std::size_t k = 0; k + 1 < axes.size(); ++k)
    for (const BudgetLine &line : d.budget)
      if (axis_name(line.axis) == axes[k]) {
        EXPECT_LE(line.rms_v, before) << axes[k];
        before = line.rms_v;
      }
}

TEST_F(Report, NamedPartsOfALineAddUpByTheirSquares) {
  const Capture capture = test::capture_with(
      {"amplitude-mismatch:k=0.02", "stray-field:b=0.01", "offset-temperature-drift"}, true,
      test::fresh_seed());
  const Diagnosis d = diagnose(capture, {});
  const View view = make_view(d, capture);
  ASSERT_EQ(view.causes.size(), d.findings.size());
  bool any = false;
  for (const BudgetLine &line : d.budget) {
    const std::vector<double> parts = named_parts(line, d.findings, view.causes);
    const double sum = std::inner_product(parts.begin(), parts.end(), parts.begin(), 0.0);
    if (sum > 0.0) {
      EXPECT_NEAR(std::sqrt(sum), line.named_rms_v, 1e-9 * line.named_rms_v);
      any = true;
    }
    // A mismatch turns with the angle whatever the temperature, and a drift does not.
    for (std::size_t f = 0; f < parts.size(); ++f) {
      const auto id = d.findings[f].effect->info().id;
      if (line.axis == Axis::temperature && id == "amplitude-mismatch") {
        EXPECT_LT(parts[f], 0.1 * line.named_rms_v);
      }
      if (line.axis == Axis::angle && id == "stray-field") {
        EXPECT_GT(parts[f], 0.3 * line.named_rms_v);
      }
    }
  }
  EXPECT_TRUE(any);
}

TEST_F(Report, SortsWhatIsLeftOverAndDrawsEachLine) {
  const Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, true, 5);
  Diagnosis d = diagnose(capture, {});
  d.structure = {{"time", "small", 1e-4},
                 {"angle", "large", 9e-3},
                 {"frequency", "middling", 2e-3},
                 {"supply", "has no column", 1e-5},
                 {"time", "smaller", 5e-5}};
  const std::string text = page(capture, d);
  EXPECT_EQ(each(text, "data-along=\"", "\""),
            (std::vector<std::string>{"angle", "frequency", "time", "time", "supply"}));
  for (const std::string &card : each(text, "data-along=\"", "</section>")) {
    const bool drawn = card.find("<svg") != card.npos;
    EXPECT_EQ(drawn, !card.starts_with("supply")) << card.substr(0, 40);
    EXPECT_EQ(card.find("No picture: ") != card.npos, !drawn);
  }
}

TEST_F(Report, SaysWhyAFindingHasNoCurve) {
  const Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, true, 6);
  const Diagnosis clean = diagnose(capture, {});
  for (const auto &[id, reason] :
       {std::pair{"sample-loss", "before any model was fitted"},
        std::pair{"excess-noise", "scatter"}, std::pair{"gain-wander", "its course is random"},
        std::pair{"clipping", "the same without it"}}) {
    Diagnosis d = clean;
    Finding f = d.findings.front();
    f.effect = find_effect(id);
    f.values.assign(f.effect->info().parameters.size(), 0.01);
    f.std_errors = f.values;
    d.findings.push_back(f);
    const std::string text = page(capture, d);
    const std::string card = each(text, "data-cause=\"" + std::string(id), "</section>")[0];
    EXPECT_NE(card.find(reason), card.npos) << id;
  }
}

TEST_F(Report, WhereOnlyTheRadiusIsJudgedNothingIsShownAcrossTheVector) {
  const Capture capture =
      test::capture_with({"amplitude-mismatch:k=0.02"}, false, test::fresh_seed());
  Diagnosis d = diagnose(capture, {});
  d.structure = {{"angle", "the radius changes", 9e-3}, {"time", "it changes, too", 1e-3}};
  ASSERT_FALSE(d.radius_only);
  const auto told = [&](const std::string &what) {
    const std::string text = page(capture, d);
    return count(each(text, "id=\"left\"", "<h2 id=\"record\"")[0], what);
  };
  EXPECT_GT(told("across the vector"), 0u);
  EXPECT_EQ(told("Only the radius was judged"), 0u);
  d.radius_only = true;
  EXPECT_EQ(told("Only the radius was judged"), 1u);
  EXPECT_EQ(told("across the vector"), 1u) << "once, to say why not";
  EXPECT_EQ(told("mV rms across"), 0u);
}

TEST_F(Report, WhatWasSeenBeforeAnyFitIsAStepWhereItGains) {
  const Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, true, 9);
  Diagnosis d = diagnose(capture, {});
  Finding f = d.findings.front();
  f.effect = find_effect("impulse-noise");
  f.values = f.std_errors = {0.001, 0.1};
  d.findings.insert(d.findings.begin(), f);
  d.findings[0].after.heldout.residual_rms_v = 0.9 * f.before.heldout.residual_rms_v;
  EXPECT_GT(count(page(capture, d), "; + impulse-noise: "), 0u);
  d.findings[0].after = d.findings[0].before;
  EXPECT_EQ(count(page(capture, d), "; + impulse-noise: "), 0u);
}

TEST(Words, WhatIsNothingInSoManyDigitsHasNoSign) {
  const ParameterInfo angle{"angle_zero_deg", "deg", 0.0, 0.0, 0.0};
  EXPECT_EQ(show(angle, -1e-9, 4.6e-5).in_full(), "0.000000 \u00b1 0.000046 deg");
  EXPECT_EQ(show(angle, -2e-6, 4.6e-5).value, "-0.000002");
}

TEST_F(Report, ShowsTheRemainderAsUnnamed) {
  const Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, true, 7);
  Diagnosis d = diagnose(capture, {});
  EXPECT_EQ(page(capture, d).find("id=\"remainder\""), std::string::npos);
  PeriodicRemainder r;
  r.sin_cos = {0.0, 0.0, 0.01};
  r.sin_sin = r.cos_cos = r.cos_sin = {0.0, 0.0, 0.0};
  d.extended.remainder = r;
  d.remainder_rms_v = 0.01;
  const std::string text = page(capture, d);
  const std::string part = each(text, "id=\"remainder\"", "<h2")[0];
  EXPECT_NE(part.find("unnamed"), part.npos);
  EXPECT_NE(part.find("trusts the reference"), part.npos);
  EXPECT_EQ(count(part, "<svg"), 1u);
  EXPECT_NE(each(text, "id=\"model\"", "</table>")[0].find("unnamed"), std::string::npos);
}

TEST_F(Report, NeedsNothingFromOutside) {
  const Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, false, 1);
  const std::string text = page(capture, diagnose(capture, {}));
  EXPECT_EQ(text.find("http:"), text.npos);
  EXPECT_EQ(text.find("https:"), text.npos);
  EXPECT_EQ(text.find("url("), text.npos);
  EXPECT_EQ(text.find("src="), text.npos);
  EXPECT_EQ(text.find("<script"), text.npos);
  EXPECT_EQ(text.find("rgb("), text.npos) << "a colour that the style sheet does not rule";
  // Two constant columns have one value, not a range from it to itself.
  EXPECT_EQ(text.find("5 to 5 V"), text.npos);
}

TEST_F(Report, TextOfTheCaptureStaysText) {
  Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, true, 2);
  capture.meta.serial = kEvil;
  capture.meta.origin = kEvil;
  DiagnosisOptions options;
  options.baseline_name = kEvil;
  const std::string text = page(capture, diagnose(capture, options));
  EXPECT_EQ(text.find("<script"), text.npos);
  EXPECT_GE(count(text, "&lt;script&gt;alert(1)&lt;/script&gt;"), 3u);
}

TEST_F(Report, TooLittleDataStillMakesAPage) {
  for (double duration_s : {0.0002, 0.01, 0.05}) {
    const Capture capture = test::capture_with({}, false, 3, duration_s);
    const Diagnosis d = diagnose(capture, {});
    const bool said = page(capture, d).find("Not enough data: ") != std::string::npos;
    EXPECT_EQ(said, d.verdict == Verdict::insufficient_data) << duration_s;
    if (duration_s < 0.001) {
      EXPECT_TRUE(said);
    }
  }
}

TEST_F(Report, AnyOriginAndUnitOfTimeIsDrawn) {
  const Capture plain = test::capture_with({"amplitude-mismatch:k=0.02"}, true, 8, 2.0);
  const auto drawn_of = [&](const char *what, double (*time)(double)) {
    Capture capture = plain;
    for (double &t : capture.time_s)
      t = time(t);
    const std::string text = page(capture, diagnose(capture, {}));
    EXPECT_EQ(text.find("class=\"undrawn\""), text.npos)
        << what << ": " << each(text, "class=\"undrawn\">", "</p>")[0];
    return count(text, "role=\"img\"");
  };
  const std::size_t pictures = drawn_of("from zero", [](double t) { return t; });
  EXPECT_GT(pictures, 10u);
  EXPECT_EQ(drawn_of("Unix seconds", [](double t) { return 1.7e9 + t; }), pictures);
  EXPECT_EQ(drawn_of("before 1970", [](double t) { return -3e9 + t; }), pictures);
  EXPECT_GT(drawn_of("microseconds", [](double t) { return 1e6 * t; }), 0u);
  EXPECT_GT(drawn_of("whole seconds", [](double t) { return std::floor(t); }), 0u);
  EXPECT_GT(drawn_of("whole Unix seconds", [](double t) { return 1.7e9 + std::floor(t); }), 0u);
  EXPECT_GT(drawn_of("one second for all", [](double) { return 1.7e9; }), 0u);
}

} // namespace
} // namespace ada
