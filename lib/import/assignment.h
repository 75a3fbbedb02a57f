// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Which column of a foreign file is which channel, and what is made of its numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "import/importer.h"

namespace ada {

struct FileColumn {
  std::string name, unit; ///< empty where the file has none
};

struct Assigned {
  std::size_t index = 0; ///< of the file's column
  double scale = 1.0, offset = 0.0;

  double value(double number) const { return scale * number + offset; }
};

struct Assignment {
  std::array<std::optional<Assigned>, kColumns.size()> channels; ///< in the order of kColumns
  std::string text;                                              ///< a line a channel

  const std::optional<Assigned> &time() const { return channels[0]; }
  ChannelSet set() const { return {channels[3].has_value(), channels[4].has_value(), channels[5].has_value()}; }
};

/// `place` begins the sentences: the file, and the line of its header. `rate_known`: no time column
/// is needed, and one that is not asked for is left alone when `rate_rules`. Throws
/// INVALID_ARGUMENT where a channel is missing or could be more than one column.
Assignment assign_columns(const std::vector<FileColumn> &columns, const ImportOptions &options,
                          const std::string &place, bool rate_known);

/// Of regular times, with no more digits than they carry; nothing where they are not regular.
std::optional<double> regular_rate(const std::vector<double> &times);

/// What is wrong with the value of a channel, or nothing.
std::string value_problem(const Column &column, double value);

} // namespace ada
