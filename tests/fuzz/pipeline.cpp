// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"
#include "diagnosis/diagnose.h"
#include "health/health.h"
#include "parsers.h"
#include "recording/columns.h"

namespace ada::test {

namespace {

/// A diagnosis takes time; longer captures hold nothing that these do not.
constexpr std::size_t kMostSamples = 3000;

Capture cut(Capture capture) {
  if (capture.size() > kMostSamples) {
    for (const Column &column : kColumns)
      if (auto &values = capture.*column.values; !values.empty())
        values.resize(kMostSamples);
    std::erase_if(capture.gaps, [](std::size_t i) { return i >= kMostSamples; });
  }
  return capture;
}

/// JSON knows no other numbers.
void check_json(const std::string &json) {
  for (const char *word : {":nan", ": nan", ":-nan", ": -nan", ":inf", ": inf", ":-inf", ": -inf"})
    promise(json.find(word) == std::string::npos, "the numbers of a result are numbers");
}

/// A refusal with a sentence is as good as an answer, but the caller has done nothing wrong.
template <class Work> void answer_or_reason(Work work) {
  try {
    work();
  } catch (const Error &e) {
    promise(e.status() == ADA4571_ERROR_UNUSABLE_DATA, "a capture that was read is at most unusable");
    promise(*e.what() != '\0', "a refusal has its reason");
  }
}

void calibrate_and_convert(const Capture &capture, CalibrationMethod method) {
  const Model model = calibrate_single(capture, method);
  const Baseline &b = model.baseline;
  promise(std::isfinite(b.amplitude_v + b.offset_sin_v + b.offset_cos_v) && b.amplitude_v > 0,
          "a calibration is of numbers");
  std::vector<ada4571_angle> angles(capture.size());
  FrameConverter(model).capture(capture, angles);
  for (const ada4571_angle &angle : angles)
    promise(std::isfinite(angle.angle_deg) || angle.status != 0, "a sound angle is a number");
}

} // namespace

Outcome run_pipeline(std::string_view input) {
  Capture capture;
  try {
    capture = cut(capture_of_text(input));
  } catch (const Error &) {
    return Outcome::refused; // parse_text_capture() looks at how
  }
  answer_or_reason([&] {
    const Health health = check_health(capture, nullptr);
    check_json(health_json(health));
    promise(!health_text(health).empty(), "a check says something");
  });
  for (const auto method :
       {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema})
    answer_or_reason([&] { calibrate_and_convert(capture, method); });
  answer_or_reason([&] {
    const Diagnosis diagnosis = diagnose(capture, {});
    check_json(to_json(diagnosis));
    promise(!to_text(diagnosis).empty(), "a diagnosis says something");
  });
  return Outcome::accepted;
}

} // namespace ada::test
