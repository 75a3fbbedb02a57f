// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>

#include "base/text.h"
#include "recording/metadata.h"
#include "recording/out_of_range.h"

namespace ada {

namespace {

constexpr std::string_view kMagic = "# ada4571-capture/";
constexpr std::string_view kVersion = "1";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kMaxHeadBytes = std::size_t{1} << 20;

void read_magic(LineReader &lines) {
  std::string_view line;
  if (!lines.next(line))
    lines.fail(1, "the file is empty");
  if (line.substr(0, kByteOrderMark.size()) == kByteOrderMark)
    line.remove_prefix(kByteOrderMark.size());
  if (line.substr(0, kMagic.size()) != kMagic)
    lines.fail(1, "this is no capture: the first line must be '# ada4571-capture/1', not " +
                      excerpt(line));
  if (const auto version = trim(line.substr(kMagic.size())); version != kVersion)
    lines.fail(kMagic.size() + 1,
               "format version " + excerpt(version) + " is not known here, only version 1 is");
}

using Keys = std::set<std::string, std::less<>>;

void read_metadata(std::string_view line, const LineReader &lines, Keys &keys,
                   CaptureMetadata &meta) {
  if (lines.bytes_read() > kMaxHeadBytes)
    lines.fail(1, "the metadata is longer than " + std::to_string(kMaxHeadBytes) + " bytes");
  const auto text = trim(line.substr(1));
  if (text.empty())
    return;
  const auto equals = text.find('=');
  if (equals == text.npos)
    lines.fail(1, "expected '# key = value', not " + excerpt(line));
  const auto key = trim(text.substr(0, equals));
  const auto value = trim(text.substr(equals + 1));
  const auto at = [&](std::string_view part) {
    return static_cast<std::size_t>(part.data() - line.data()) + 1;
  };
  if (!keys.emplace(key).second)
    lines.fail(at(text), "the key " + excerpt(key) + " is given twice");
  const std::string problem = assign_metadata(meta, key, value);
  if (!problem.empty())
    lines.fail(value.empty() ? at(text) : at(value), problem);
}

constexpr std::ptrdiff_t kMostDigits = 15;

/// Of so few digits both the digits and the power of ten are doubles, and their quotient, rounded
/// once, is what std::from_chars gives (Clinger, "How to read floating point numbers accurately",
/// 1990).
double of_digits(std::int64_t digits, std::ptrdiff_t decimals, bool negative) {
  static constexpr double kPowers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                       1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const double value = static_cast<double>(digits) / kPowers[decimals];
  return negative ? -value : value;
}

/// A number as programs print it, "-1.653748", up to its comma; `at` is then moved there. False for
/// any other form.
bool plain_number(const char *&at, const char *end, double &value) {
  const bool negative = at < end && *at == '-';
  const char *const first = at + (negative ? 1 : 0);
  std::int64_t digits = 0;
  const auto run = [&digits, end](const char *from, std::ptrdiff_t before) {
    const char *const most = from + std::min(end - from, kMostDigits + 1 - before);
    const char *c = from;
    for (unsigned digit; c < most && (digit = static_cast<unsigned>(*c - '0')) < 10; ++c)
      digits = 10 * digits + digit;
    return c;
  };
  const char *c = run(first, 0);
  const std::ptrdiff_t whole = c - first;
  std::ptrdiff_t decimals = 0;
  if (whole > 0 && whole <= kMostDigits && c < end && *c == '.') {
    const char *const point = c;
    c = run(point + 1, whole);
    decimals = c - point - 1;
  }
  if (whole == 0 || whole + decimals > kMostDigits || (c < end && *c != ','))
    return false;
  if (c > first + whole && decimals == 0)
    return false; // "5."
  value = of_digits(digits, decimals, negative);
  at = c;
  return true;
}

/// The digits that eight characters begin with, all at once: Lemire, "Number parsing at a gigabyte
/// per second", Software: Practice and Experience 51 (2021), section 5.
class EightCharacters {
public:
  explicit EightCharacters(const char *from) {
    std::memcpy(&values_, from, sizeof values_);
    values_ ^= 0x3030303030303030;
    // Carries spoil only what stands behind the first character that is no digit.
    const std::uint64_t others = ((values_ + 0x7676767676767676) | values_) & 0x8080808080808080;
    count_ = others == 0 ? 8 : std::countr_zero(others) / 8;
  }
  int count() const { return count_; } ///< of the digits
  std::int64_t digits() const {
    if (count_ == 0)
      return 0;
    std::uint64_t v = values_ << (64 - 8 * count_); // zeros in front
    v = v * 10 + (v >> 8);
    constexpr std::uint64_t kPairs = 0x000000FF000000FF;
    v = (v & kPairs) * (100 + (std::uint64_t{1000000} << 32)) +
        (v >> 16 & kPairs) * (1 + (std::uint64_t{10000} << 32));
    return static_cast<std::int64_t>(v >> 32);
  }

private:
  std::uint64_t values_ = 0; ///< of the characters
  int count_ = 0;
};

/// The same where so many characters may be read: a sign, seven digits, the point and 24 more.
constexpr std::ptrdiff_t kReadAhead = 33;

/// As plain_number, of at most seven digits before the point; whatever ends it.
bool plain_number_ahead(const char *&at, double &value) {
  static constexpr std::int64_t kPowers[] = {1,      10,      100,      1000,     10000,
                                             100000, 1000000, 10000000, 100000000};
  const bool negative = *at == '-';
  const char *c = at + (negative ? 1 : 0);
  const EightCharacters whole(c);
  if (whole.count() == 0 || whole.count() == 8)
    return false;
  c += whole.count();
  std::int64_t digits = whole.digits();
  int decimals = 0;
  if (*c == '.') {
    ++c;
    for (int count = 8; count == 8; c += count) {
      const EightCharacters more(c);
      count = more.count();
      decimals += count;
      if (whole.count() + decimals > kMostDigits)
        return false;
      digits = digits * kPowers[count] + more.digits();
    }
    if (decimals == 0)
      return false; // "5."
  }
  value = of_digits(digits, decimals, negative);
  at = c;
  return true;
}

/// Behind the comma that ends a cell of up to fifteen characters; none where there is none in this
/// line.
const char *behind_comma(const char *at) {
  const char *const most = at + kMostDigits + 2;
  while (at < most && *at != ',' && *at != '\n')
    ++at;
  return at < most && *at == ',' ? at + 1 : nullptr;
}

double number(std::string_view line, std::string_view cell, const Column &column,
              const LineReader &lines) {
  // Most cells are a plain number; blanks and a plus sign take the slower way.
  double value = 0;
  auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (result.ec != std::errc() || result.ptr != cell.data() + cell.size()) {
    cell = trim(cell);
    if (cell.size() > 1 && cell.front() == '+' && cell[1] != '-')
      cell.remove_prefix(1);
    result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  } else if (std::fabs(value) <= column.limit) {
    return value;
  }
  const auto at = static_cast<std::size_t>(cell.data() - line.data()) + 1;
  const auto fail = [&](const char *what) {
    lines.fail(at, std::string(column.name) + " " + what + ": " + excerpt(cell));
  };
  if (cell.empty())
    lines.fail(at, std::string(column.name) + " is missing");
  if (result.ec == std::errc::invalid_argument || result.ptr != cell.data() + cell.size())
    fail("is not a number");
  if (result.ec != std::errc() || !(std::fabs(value) <= column.limit))
    fail(std::isnan(value) ? "is not a number" : out_of_range(column, value).c_str());
  return value;
}

} // namespace

TextRows::TextRows(std::string_view line, const LineReader &lines,
                   std::vector<std::string> &ignored) {
  std::set<std::string, std::less<>> names;
  for (std::size_t begin = 0; begin <= line.size();) {
    const auto comma = std::min(line.find(',', begin), line.size());
    const auto name = trim(line.substr(begin, comma - begin));
    if (name.empty())
      lines.fail(begin + 1, "a column has no name");
    if (!names.emplace(name).second)
      lines.fail(begin + 1, "the column " + excerpt(name) + " is there twice");
    std::size_t cell = 0;
    while (cell < kColumns.size() && kColumns[cell].name != name)
      ++cell;
    cells_.push_back(cell);
    if (cell == kIgnored)
      ignored.emplace_back(name);
    begin = comma + 1;
  }
  for (const Column &column : kColumns)
    if (column.required && names.find(column.name) == names.end())
      lines.fail(1, "the column " + std::string(column.name) + " is missing from the header " +
                        excerpt(line));
}

ChannelSet TextRows::channels() const {
  const auto has = [this](std::size_t c) {
    return std::find(cells_.begin(), cells_.end(), c) != cells_.end();
  };
  return {has(3), has(4), has(5)};
}

TextRows::Count TextRows::read(LineReader &lines, ColumnMask wanted, std::size_t most,
                               Store &out, std::size_t blank_line) const {
  Count count{.blank_line = blank_line};
  std::string_view line;
  while (count.rows < most) {
    if (!count.blank_line && wanted && read_plain_row(lines, wanted, out)) {
      ++count.rows;
      continue;
    }
    if (!lines.next(line))
      break;
    const bool may_be_blank = line.empty() || static_cast<unsigned char>(line.front()) <= ' ';
    if (may_be_blank && trim(line).empty()) {
      count.blank_line = count.blank_line ? count.blank_line : lines.line_number();
      continue;
    }
    if (count.blank_line)
      lines.fail(1, "rows go on after the empty line " + std::to_string(count.blank_line));
    if (wanted)
      read_row(line, lines, wanted, out);
    ++count.rows;
  }
  return count;
}

/// Most rows hold plain numbers only: they are read without looking for their end first. False, and
/// nothing read, for any other one.
bool TextRows::read_plain_row(LineReader &lines, ColumnMask wanted, Store &out) const {
  if constexpr (std::endian::native != std::endian::little)
    return false;
  const std::string_view ahead = lines.ahead();
  if (ahead.size() <= cells_.size() * kReadAhead || ahead.front() == '#')
    return false;
  const char *at = ahead.data();
  std::array<double, kColumnCount> row;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const bool last = i + 1 == cells_.size();
    const std::size_t c = cells_[i];
    if (!(wanted & 1u << c) && !last) {
      if (at = behind_comma(at); at == nullptr)
        return false;
      continue;
    }
    double value = 0;
    if (!plain_number_ahead(at, value) || *at != (last ? '\n' : ','))
      return false;
    ++at;
    if (c == kIgnored)
      continue;
    row[c] = value;
    if (!(std::fabs(value) <= kColumns[c].limit))
      return false;
  }
  if (at - ahead.data() > static_cast<std::ptrdiff_t>(LineReader::kMaxLine) ||
      (wanted & kTimeColumn && !out[0].empty() && row[0] < out[0].back()))
    return false;
  for (const std::size_t c : cells_)
    if (wanted & 1u << c)
      out[c].push_back(row[c]);
  lines.skip_line(at);
  return true;
}

void TextRows::read_row(std::string_view line, const LineReader &lines, ColumnMask wanted,
                        Store &out) const {
  if (line.front() == '#')
    lines.fail(1, "metadata must stand before the header line");
  const char *at = line.data();
  const char *const end = at + line.size();
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const std::size_t c = cells_[i];
    const bool asked = wanted & 1u << c;
    const char *stop = at;
    double value = 0.0;
    const bool plain =
        asked && plain_number(stop, end, value) && std::fabs(value) <= kColumns[c].limit;
    if (!plain) // a cell is short: a call of memchr would take longer
      stop = std::find(at, end, ',');
    if (asked)
      out[c].push_back(
          plain ? value
                : number(line, {at, static_cast<std::size_t>(stop - at)}, kColumns[c], lines));
    if ((stop == end) != (i + 1 == cells_.size())) {
      const auto count = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
      lines.fail(line.size() + 1, "the row has " + std::to_string(count) + " cells, the header " +
                                      std::to_string(cells_.size()));
    }
    at = stop + 1;
  }
  if (wanted & kTimeColumn)
    check_time(line, lines, out[0]);
}

void TextRows::check_time(std::string_view line, const LineReader &lines,
                          const std::vector<double> &time) const {
  if (time.size() < 2 || time.back() >= time[time.size() - 2])
    return;
  std::size_t column = 1;
  for (std::size_t i = 0; cells_[i] != 0; ++i)
    column = line.find(',', column - 1) + 2;
  lines.fail(column, "time_s goes back from " + shortest(time[time.size() - 2]) + " to " +
                         shortest(time.back()));
}

TextHead read_text_head(LineReader &lines) {
  TextHead head;
  Keys keys;
  read_magic(lines);
  std::string_view line;
  while (true) {
    if (!lines.next(line))
      lines.fail(1, "the file ends before the header line with the column names");
    if (line.empty() || line.front() != '#')
      break;
    read_metadata(line, lines, keys, head.meta);
  }
  head.rows = TextRows(line, lines, head.ignored_columns);
  return head;
}

} // namespace ada
