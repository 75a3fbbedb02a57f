// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/health.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "health/checks.h"
#include "health/criteria.h"

namespace ada {

bool Health::sound() const {
  return !too_few && std::none_of(checks.begin(), checks.end(), [](const HealthCheck &c) {
    return c.state == HealthState::failed;
  });
}

Health check_health(const RecordingToFit &what, const Model *model) {
  using namespace health;
  if (what.recording.size() == 0)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, "the capture holds no sample");
  Health out;
  const Evidence e = gather(what, model);
  if (const std::size_t n = e.tally.usable; n < kFewestSamples) {
    out.too_few = true;
    out.against = "nothing";
    out.checks = {
        check_range(e), check_numbers(e),
        cannot_tell("samples", fmt::format("{} are too few to judge a sensor by: at least "
                                           "{} are needed",
                                           n, kFewestSamples))};
    return out;
  }
  out.against = e.yardstick_name;
  out.checks = {check_range(e),     check_supply(e), check_rails(e),    check_rotation(e),
                check_amplitude(e), check_radius(e), check_clipping(e), check_stuck(e),
                check_short(e),     check_spikes(e), check_numbers(e),  check_gaps(e),
                check_noise(e)};
  if (e.capture.has_vtemp())
    out.checks.push_back(check_vtemp(e));
  if (e.capture.has_reference())
    out.checks.push_back(check_reference(e));
  return out;
}

Health check_health(const Capture &capture, const Model *model) {
  const auto recording = recording_of(capture);
  return check_health(RecordingToFit(*recording), model);
}

} // namespace ada
