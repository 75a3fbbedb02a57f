// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A table of numbers in text, found out from its first lines: separator, decimal mark, where the
// rows begin, what their columns are called.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import/assignment.h"

namespace ada {

/// A cell of a line, without blanks and quotes around it; `column` is its first byte, from 1.
struct TextCell {
  std::string_view text;
  std::size_t column = 1;
};

/// `separator` ' ' is any number of blanks. Empty cells at the end of a line are left out.
void split_cells(std::string_view line, char separator, std::vector<TextCell> &cells);

/// The whole text as a finite number with that decimal mark.
std::optional<double> parse_decimal(std::string_view text, char decimal);

struct Table {
  char separator = ',', decimal = '.';
  std::size_t first_row = 0;            ///< of the lines given
  std::optional<std::size_t> name_line; ///< likewise
  std::vector<FileColumn> columns;
  std::optional<double> rate_hz; ///< from what stands before the rows
};

/// `lines` are the first of the file `shown`; `all`: there are no more.
Table find_table(const std::vector<std::string> &lines, bool all, const ImportOptions &options,
                 const std::string &shown);

} // namespace ada
