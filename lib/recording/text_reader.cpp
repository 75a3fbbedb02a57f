// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/descriptor.h"
#include "base/text.h"
#include "recording/capture_file.h"
#include "recording/columns.h"
#include "recording/identity.h"
#include "recording/line_reader.h"
#include "recording/metadata.h"
#include "recording/out_of_range.h"

namespace ada {

namespace {

constexpr std::string_view kMagic = "# ada4571-capture/";
constexpr std::string_view kVersion = "1";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kMaxHeadBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxReserve = std::size_t{1} << 24;

class TextReader {
public:
  TextReader(int fd, const std::string &shown) : lines_(fd, shown) {
    struct stat info {};
    if (::fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0)
      file_bytes_ = static_cast<std::size_t>(info.st_size);
  }

  Capture read() {
    read_magic();
    std::string_view line;
    while (true) {
      if (!lines_.next(line))
        lines_.fail(1, "the file ends before the header line with the column names");
      if (line.empty() || line.front() != '#')
        break;
      read_metadata(line);
    }
    read_header(line);
    read_rows();
    capture_.gaps = gaps_in_time(capture_);
    capture_.identity = capture_identity(capture_);
    return std::move(capture_);
  }

private:
  /// Where the values of one column of the file go; without a meaning here `values` is null.
  struct Cell {
    const Column *column = nullptr;
    std::vector<double> *values = nullptr;
  };

  void read_magic() {
    std::string_view line;
    if (!lines_.next(line))
      throw_empty();
    if (line.substr(0, kByteOrderMark.size()) == kByteOrderMark)
      line.remove_prefix(kByteOrderMark.size());
    if (line.substr(0, kMagic.size()) != kMagic)
      lines_.fail(1, "this is no capture: the first line must be '# ada4571-capture/1', not " +
                         excerpt(line));
    if (const auto version = trim(line.substr(kMagic.size())); version != kVersion)
      lines_.fail(kMagic.size() + 1,
                  "format version " + excerpt(version) + " is not known here, only version 1 is");
  }

  [[noreturn]] void throw_empty() const { lines_.fail(1, "the file is empty"); }

  void read_metadata(std::string_view line) {
    if (lines_.bytes_read() > kMaxHeadBytes)
      lines_.fail(1, "the metadata is longer than " + std::to_string(kMaxHeadBytes) + " bytes");
    const auto text = trim(line.substr(1));
    if (text.empty())
      return;
    const auto equals = text.find('=');
    if (equals == text.npos)
      lines_.fail(1, "expected '# key = value', not " + excerpt(line));
    const auto key = trim(text.substr(0, equals));
    const auto value = trim(text.substr(equals + 1));
    const auto at = [&](std::string_view part) {
      return static_cast<std::size_t>(part.data() - line.data()) + 1;
    };
    if (!keys_.emplace(key).second)
      lines_.fail(at(text), "the key " + excerpt(key) + " is given twice");
    const std::string problem = assign_metadata(capture_.meta, key, value);
    if (!problem.empty())
      lines_.fail(value.empty() ? at(text) : at(value), problem);
  }

  void read_header(std::string_view line) {
    std::set<std::string, std::less<>> names;
    for (std::size_t begin = 0; begin <= line.size();) {
      const auto comma = std::min(line.find(',', begin), line.size());
      const auto name = trim(line.substr(begin, comma - begin));
      if (name.empty())
        lines_.fail(begin + 1, "a column has no name");
      if (!names.emplace(name).second)
        lines_.fail(begin + 1, "the column " + excerpt(name) + " is there twice");
      cells_.push_back(cell_for(name));
      begin = comma + 1;
    }
    for (const Column &column : kColumns)
      if (column.required && names.find(column.name) == names.end())
        lines_.fail(1, "the column " + std::string(column.name) + " is missing from the header " +
                           excerpt(line));
  }

  Cell cell_for(std::string_view name) {
    for (const Column &column : kColumns)
      if (column.name == name)
        return {&column, &(capture_.*column.values)};
    capture_.ignored_columns.emplace_back(name);
    return {};
  }

  void read_rows() {
    const std::size_t head_bytes = lines_.bytes_read();
    std::size_t blank_line = 0, rows = 0;
    std::string_view line;
    while (lines_.next(line)) {
      if (trim(line).empty()) {
        blank_line = blank_line ? blank_line : lines_.line_number();
        continue;
      }
      if (blank_line)
        lines_.fail(1, "rows go on after the empty line " + std::to_string(blank_line));
      read_row(line);
      if (++rows == 1024)
        reserve((lines_.bytes_read() - head_bytes) / rows);
    }
    if (rows == 0)
      lines_.fail(1, "there is no row after the header line");
  }

  /// Room for the whole file, judged by its first rows, so that the columns need not grow.
  void reserve(std::size_t bytes_a_row) {
    const std::size_t rows = std::min(file_bytes_ / bytes_a_row * 65 / 64, kMaxReserve);
    for (const Cell &cell : cells_)
      if (cell.values)
        cell.values->reserve(rows);
  }

  void read_row(std::string_view line) {
    if (line.front() == '#')
      lines_.fail(1, "metadata must stand before the header line");
    const char *at = line.data();
    const char *const end = at + line.size();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const char *stop =
          static_cast<const char *>(std::memchr(at, ',', static_cast<std::size_t>(end - at)));
      if (stop == nullptr)
        stop = end;
      if (cells_[i].values)
        cells_[i].values->push_back(
            number(line, {at, static_cast<std::size_t>(stop - at)}, *cells_[i].column));
      if ((stop == end) != (i + 1 == cells_.size()))
        fail_cell_count(line);
      at = stop + 1;
    }
    check_time(line);
  }

  [[noreturn]] void fail_cell_count(std::string_view line) const {
    const auto count = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    lines_.fail(line.size() + 1, "the row has " + std::to_string(count) + " cells, the header " +
                                     std::to_string(cells_.size()));
  }

  double number(std::string_view line, std::string_view cell, const Column &column) const {
    // Most cells are a plain number; blanks and a plus sign take the slower way.
    double value = 0;
    auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (result.ec != std::errc() || result.ptr != cell.data() + cell.size()) {
      cell = trim(cell);
      if (cell.size() > 1 && cell.front() == '+' && cell[1] != '-')
        cell.remove_prefix(1);
      result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    }
    const auto at = static_cast<std::size_t>(cell.data() - line.data()) + 1;
    const auto fail = [&](const char *what) {
      lines_.fail(at, std::string(column.name) + " " + what + ": " + excerpt(cell));
    };
    if (cell.empty())
      lines_.fail(at, std::string(column.name) + " is missing");
    if (result.ec == std::errc::invalid_argument || result.ptr != cell.data() + cell.size())
      fail("is not a number");
    if (result.ec != std::errc() || !(std::fabs(value) <= column.limit))
      fail(std::isnan(value) ? "is not a number" : out_of_range(column, value).c_str());
    return value;
  }

  void check_time(std::string_view line) {
    const auto &time = capture_.time_s;
    if (time.size() < 2 || time.back() >= time[time.size() - 2])
      return;
    std::size_t column = 1;
    const auto is_time = [](const Cell &cell) {
      return cell.values && cell.column == &kColumns[0];
    };
    const auto index = std::find_if(cells_.begin(), cells_.end(), is_time) - cells_.begin();
    for (std::ptrdiff_t i = 0; i < index; ++i)
      column = line.find(',', column - 1) + 2;
    lines_.fail(column, "time_s goes back from " + shortest(time[time.size() - 2]) + " to " +
                            shortest(time.back()));
  }

  LineReader lines_;
  std::size_t file_bytes_ = 0;
  std::set<std::string, std::less<>> keys_;
  std::vector<Cell> cells_;
  Capture capture_;
};

} // namespace

Capture read_text_capture(int fd, const std::string &shown) {
  return TextReader(fd, shown).read();
}

Capture read_text_capture(const std::string &path) {
  if (path == "-")
    return read_text_capture(STDIN_FILENO, "standard input");
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (fd.get() < 0)
    throw system_error(errno, path, "cannot open");
  return read_text_capture(fd.get(), path);
}

} // namespace ada
