// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Models and calibrations as TOML files; docs/model-file.md has the format.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "model/model.h"

namespace ada {

/// Reads a model; "-" is standard input. Refuses whatever it does not fully understand (unknown
/// keys, effects and parameters, values out of range, another schema, a wrong checksum) with
/// Error(ADA4571_ERROR_FORMAT) "file:line:column: why".
Model read_model(const std::string &path);

/// Throws Error(ADA4571_ERROR_INVALID_ARGUMENT) when a number is outside of what a file may hold.
void check_model(const Model &model);

/// Checks, and writes whole or not at all; "-" is standard output.
void write_model(const Model &model, const std::string &path);

/// The same as text; `shown` names it in messages.
Model model_from_toml(std::string_view text, const std::string &shown);
std::string model_to_toml(const Model &model);

/// "crc32:1a2b3c4d" over the text without its line `line` (from 1; 0: over all of it). Carriage
/// returns do not count, so that a change of line ends is no change.
std::string model_checksum(std::string_view text, std::size_t line);

inline constexpr std::string_view kModelSchema = "ada4571-model/1";

// Words of the table [remainder].
struct RemainderSeries {
  std::string_view key;
  std::vector<double> PeriodicRemainder::*values;
};
inline constexpr std::array<RemainderSeries, 4> kRemainderSeries{
    {{"sin_cos", &PeriodicRemainder::sin_cos},
     {"sin_sin", &PeriodicRemainder::sin_sin},
     {"cos_cos", &PeriodicRemainder::cos_cos},
     {"cos_sin", &PeriodicRemainder::cos_sin}}};
inline constexpr std::string_view kMechanical = "mechanical", kElectrical = "electrical";

} // namespace ada
