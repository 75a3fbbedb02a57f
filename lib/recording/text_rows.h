// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The text form in parts: what stands before the rows, and the rows.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "recording/columns.h"
#include "recording/line_reader.h"

namespace ada {

/// Rows under one header line. Whatever is wrong is said with file, line and column
/// (LineReader::fail).
class TextRows {
public:
  using Store = std::array<std::vector<double>, kColumnCount>;

  TextRows() = default;
  /// From the header line, which `lines` gave last; names without a meaning here go to `ignored`.
  TextRows(std::string_view header, const LineReader &lines, std::vector<std::string> &ignored);

  ChannelSet channels() const;

  struct Count {
    std::size_t rows = 0, blank_line = 0; ///< number of the first empty line, 0 without
  };
  /// Appends the wanted columns of up to `most` rows to `out`. Each column that is wanted is
  /// checked, and so are time, if it is, and the number of cells. `blank_line` is the number of an
  /// empty line that was before, 0 without.
  Count read(LineReader &lines, ColumnMask wanted, std::size_t most, Store &out,
             std::size_t blank_line = 0) const;

private:
  static constexpr std::size_t kIgnored = kColumnCount;

  bool read_plain_row(LineReader &lines, ColumnMask wanted, Store &out) const;
  void read_row(std::string_view line, const LineReader &lines, ColumnMask wanted,
                Store &out) const;
  void check_time(std::string_view line, const LineReader &lines,
                  const std::vector<double> &time) const;

  std::vector<std::size_t> cells_; ///< in the order of the file: index into kColumns, or kIgnored
};

struct TextHead {
  CaptureMetadata meta;
  std::vector<std::string> ignored_columns;
  TextRows rows;
};

/// Reads up to the header line and including it.
TextHead read_text_head(LineReader &lines);

} // namespace ada
