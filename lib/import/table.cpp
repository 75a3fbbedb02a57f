// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/table.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/text.h"
#include "import/preamble.h"
#include "import/units.h"

namespace ada {

namespace {

constexpr std::array kSeparators = {'\t', ';', ',', '|', ' '};
/// Rows of one width that make a table: fewer could stand in a preamble.
constexpr std::size_t kRowsOfATable = 3;

struct Way {
  char separator, decimal;
  std::size_t first_row = 0, width = 0;
};

std::string in_words(char c) {
  return c == '\t' ? "a tab" : c == ' ' ? "blanks" : std::string("'") + c + "'";
}

class Finder {
public:
  Finder(const std::vector<std::string> &lines, bool all, const ImportOptions &options,
         const std::string &shown)
      : lines_(lines), all_(all), options_(options), shown_(shown) {}

  Table run() {
    const Way way = only_way();
    Table table{way.separator, way.decimal, way.first_row, {}, {}, {}};
    table.columns.resize(way.width);
    name_columns(table);
    table.rate_hz = preamble_rate(lines_, way.first_row, way.separator, way.decimal);
    return table;
  }

private:
  [[noreturn]] void refuse(std::size_t line, const std::string &what) const {
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ":" + std::to_string(line + 1) + ":1: " + what);
  }

  /// Cells of a row of numbers; 0 when it is none.
  std::size_t row_width(std::size_t line, const Way &way) {
    split_cells(lines_[line], way.separator, cells_);
    const bool numbers = std::all_of(cells_.begin(), cells_.end(), [&](const TextCell &cell) {
      return cell.text.empty() || parse_decimal(cell.text, way.decimal);
    });
    return numbers && cells_.size() >= 2 ? cells_.size() : 0;
  }

  bool blank(std::size_t line) const { return trim(lines_[line]).empty(); }

  /// Where kRowsOfATable rows of one width follow each other; all of them where there are no more.
  bool find_rows(Way &way) {
    const std::size_t least = options_.header_lines.value_or(0);
    for (std::size_t first = least; first < lines_.size(); ++first) {
      if (blank(first))
        continue;
      way.first_row = first;
      way.width = row_width(first, way);
      if (way.width > 0 && goes_on(way))
        return true;
      if (options_.header_lines)
        return false;
    }
    return false;
  }

  bool goes_on(const Way &way) {
    std::size_t rows = 1;
    for (std::size_t line = way.first_row + 1; line < lines_.size() && rows < kRowsOfATable; ++line) {
      if (blank(line))
        continue;
      if (row_width(line, way) != way.width)
        return false;
      ++rows;
    }
    return rows == kRowsOfATable || all_;
  }

  Way only_way() {
    std::vector<Way> ways;
    for (const char separator : kSeparators)
      for (const char decimal : {'.', ','}) {
        Way way{separator, decimal};
        const bool wanted = options_.separator.value_or(separator) == separator &&
                            options_.decimal.value_or(decimal) == decimal && separator != decimal;
        if (wanted && find_rows(way))
          ways.push_back(way);
      }
    keep_earliest(ways);
    keep_better_marks(ways);
    if (ways.empty())
      refuse_no_rows();
    if (ways.size() > 1)
      refuse(ways[0].first_row, "the rows can be read with " + in_words(ways[0].separator) +
                                    " or with " + in_words(ways[1].separator) +
                                    " between the columns: give --separator and --decimal");
    return ways[0];
  }

  /// A way that begins later takes rows for a preamble.
  static void keep_earliest(std::vector<Way> &ways) {
    std::size_t first = static_cast<std::size_t>(-1);
    for (const Way &way : ways)
      first = std::min(first, way.first_row);
    std::erase_if(ways, [first](const Way &way) { return way.first_row > first; });
  }

  /// Whole numbers at the beginning read the same with either mark: what follows decides.
  void keep_better_marks(std::vector<Way> &ways) {
    for (std::size_t i = 1; i < ways.size(); ++i)
      if (ways[i].separator == ways[i - 1].separator) {
        const bool point = rows_read(ways[i - 1]) >= rows_read(ways[i]);
        ways.erase(ways.begin() + static_cast<std::ptrdiff_t>(point ? i : i - 1));
        --i;
      }
  }

  std::size_t rows_read(const Way &way) {
    std::size_t rows = 0;
    for (std::size_t line = way.first_row; line < lines_.size(); ++line)
      rows += row_width(line, way) > 0;
    return rows;
  }

  [[noreturn]] void refuse_no_rows() {
    if (options_.header_lines)
      refuse(std::min(*options_.header_lines, lines_.size()),
             "after so many header lines no rows of numbers begin");
    refuse(0, "no rows of two or more numbers are found in the first " +
                  std::to_string(lines_.size()) +
                  " lines: say how many header lines there are, the separator and the decimal mark");
  }

  /// The line above the rows, or the one above that where it only has units.
  void name_columns(Table &table) {
    const auto above = line_above(table.first_row);
    if (!above)
      return;
    const auto cells = words(*above, table.separator);
    const bool units =
        std::any_of(cells.begin(), cells.end(), is_unit) &&
        std::all_of(cells.begin(), cells.end(), [&](const std::string &cell) {
          return cell.empty() || is_unit(cell) || parse_decimal(cell, table.decimal);
        });
    const auto names = units ? line_above(*above) : above;
    if (units)
      for (std::size_t i = 0; i < std::min(cells.size(), table.columns.size()); ++i)
        table.columns[i].unit = unit_word(cells[i]);
    if (names)
      take_names(table, *names);
  }

  void take_names(Table &table, std::size_t line) {
    const auto cells = words(line, table.separator);
    if (cells.size() < 2)
      return;
    const auto named = std::count_if(cells.begin(), cells.end(),
                                     [](const std::string &cell) { return !cell.empty(); });
    const bool fewer = cells.size() < table.columns.size();
    if (fewer && table.separator == ',' && table.columns.size() >= 2 * static_cast<std::size_t>(named))
      refuse(table.first_row,
             "the rows have " + std::to_string(table.columns.size()) + " cells and line " +
                 std::to_string(line + 1) + " names " + std::to_string(named) +
                 " columns: a comma cannot be separator and decimal mark at once");
    for (std::size_t i = 0; i < std::min(cells.size(), table.columns.size()); ++i) {
      const NameAndUnit found = split_unit(cells[i]);
      table.columns[i].name = found.name;
      if (table.columns[i].unit.empty())
        table.columns[i].unit = found.unit;
    }
    table.name_line = line;
  }

  std::optional<std::size_t> line_above(std::size_t line) const {
    while (line-- > 0)
      if (!blank(line))
        return line;
    return std::nullopt;
  }

  /// Cells without the sign of a comment before the first.
  std::vector<std::string> words(std::size_t line, char separator) {
    std::string_view text = trim(lines_[line]);
    if (!text.empty() && (text.front() == '#' || text.front() == '%') && separator != '#')
      text = trim(text.substr(1));
    split_cells(text, separator, cells_);
    std::vector<std::string> out;
    for (const TextCell &cell : cells_)
      out.emplace_back(cell.text);
    return out;
  }

  const std::vector<std::string> &lines_;
  bool all_;
  const ImportOptions &options_;
  const std::string &shown_;
  std::vector<TextCell> cells_;
};

} // namespace

void split_cells(std::string_view line, char separator, std::vector<TextCell> &cells) {
  cells.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    if (separator == ' ') {
      begin = std::min(line.find_first_not_of(" \t", begin), line.size());
      if (begin == line.size())
        break;
    }
    std::size_t end = begin, quotes = 0;
    for (; end < line.size() && (line[end] != separator || quotes % 2 == 1); ++end)
      quotes += line[end] == '"';
    std::string_view text = trim(line.substr(begin, end - begin));
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
      text = trim(text.substr(1, text.size() - 2));
    cells.push_back({text, static_cast<std::size_t>(text.data() - line.data()) + 1});
    begin = end + 1;
  }
  while (!cells.empty() && cells.back().text.empty())
    cells.pop_back();
}

std::optional<double> parse_decimal(std::string_view text, char decimal) {
  if (!text.empty() && text.front() == '+')
    text.remove_prefix(1);
  if (text.empty() || text.front() == '+' || text.size() > 64)
    return std::nullopt;
  if (decimal == '.')
    return parse_number(text);
  // "1," is no number: the comma may separate.
  if (text.find('.') != text.npos || text.back() == ',' || text.front() == ',')
    return std::nullopt;
  std::array<char, 64> plain{};
  std::replace_copy(text.begin(), text.end(), plain.begin(), ',', '.');
  return parse_number({plain.data(), text.size()});
}

Table find_table(const std::vector<std::string> &lines, bool all, const ImportOptions &options,
                 const std::string &shown) {
  return Finder(lines, all, options, shown).run();
}

} // namespace ada
