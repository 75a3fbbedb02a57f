// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A model can describe a capture down to its noise, and the capture be none of the sensor that it
// states: the wrong supply, a wrong scale. The checks of health/ know that, a fit does not.
#pragma once

#include <string>

#include "diagnosis/words/result.h"
#include "health/health.h"

namespace ada {

/// Adds the checks of a capture that failed; `which` stands before their sentences ("capture 2: "),
/// empty where there is one only. Where the volts cannot be those of the sensor, that they fit is
/// no proof that nothing is wrong: "no discrepancy" becomes "insufficient data", with the sentence.
void add_checks(Diagnosis &diagnosis, const Health &health, const std::string &which = {});

} // namespace ada
