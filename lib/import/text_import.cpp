// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/text_import.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "import/table.h"
#include "import/units.h"
#include "recording/line_reader.h"
#include "recording/metadata.h"

namespace ada {

namespace {

/// What is looked at before the first frame: enough for any preamble, and for a rate.
constexpr std::size_t kHeadLines = 2000, kHeadBytes = std::size_t{1} << 20;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string quoted(char c) {
  return c == '\t' ? "tab" : c == ' ' ? "blanks" : std::string("'") + c + "'";
}

class TextImport final : public Importer {
public:
  TextImport(Descriptor fd, const std::string &shown, const ImportOptions &options)
      : fd_(std::move(fd)), shown_(shown), lines_(fd_.get(), shown) {
    read_head();
    table_ = find_table(head_, head_ended_, options, shown_);
    next_head_ = table_.first_row;
    row_cells_ = table_.columns.size();
    const bool other_rate = options.sample_rate_hz > 0.0 || table_.rate_hz;
    columns_ = assign_columns(table_.columns, options, place_of_names(), other_rate);
    channels_ = columns_.set();
    choose_clock(options);
    describe(options);
  }

  std::size_t read(std::span<Frame> out) override {
    std::size_t n = 0;
    std::string_view line;
    while (n < out.size() && next_line(line))
      if (!trim(line).empty())
        out[n++] = frame_of(line);
    return n;
  }

private:
  void read_head() {
    std::string_view line;
    std::size_t bytes = 0;
    while (head_.size() < kHeadLines && bytes < kHeadBytes && lines_.next(line)) {
      if (head_.empty() && line.starts_with(kByteOrderMark))
        line.remove_prefix(kByteOrderMark.size());
      refuse_binary(line);
      head_.emplace_back(line);
      bytes += line.size();
    }
    head_ended_ = head_.size() < kHeadLines && bytes < kHeadBytes;
    if (head_.empty())
      lines_.fail(1, "the file is empty");
  }

  void refuse_binary(std::string_view line) const {
    if (head_.empty() && (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")))
      lines_.fail(1, "the text is in UTF-16: save it as UTF-8 or ASCII");
    if (const auto at = line.find('\0'); at != line.npos)
      lines_.fail(at + 1, "this is no text: there is a byte of zero");
  }

  std::string place_of_names() const {
    return shown_ + ":" + std::to_string(table_.name_line.value_or(table_.first_row) + 1);
  }

  /// The next line, of the head first; line_ is its number.
  bool next_line(std::string_view &line) {
    if (next_head_ < head_.size()) {
      line = head_[next_head_++];
      line_ = next_head_;
      return true;
    }
    const bool there = !head_ended_ && lines_.next(line);
    line_ = lines_.line_number();
    return there;
  }

  [[noreturn]] void fail(std::size_t column, const std::string &what) const {
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ":" + std::to_string(line_) + ":" +
                                          std::to_string(column) + ": " + what);
  }

  Frame frame_of(std::string_view line) {
    split_cells(line, table_.separator, cells_);
    if (cells_.size() > row_cells_)
      fail(cells_[row_cells_].column, "the row has " + std::to_string(cells_.size()) +
                                          " cells, the first one has " +
                                          std::to_string(row_cells_));
    Frame frame = empty_frame();
    for (std::size_t c = 0; c < kColumns.size(); ++c)
      if (const auto &assigned = columns_.channels[c])
        frame.*kColumns[c].field = value(line, kColumns[c], *assigned);
    if (!columns_.time())
      frame.time_s = static_cast<double>(rows_) / rate_hz_;
    else if (rows_ > 0 && frame.time_s < last_time_s_)
      fail(cells_[columns_.time()->index].column,
           "the time goes back from " + shortest(last_time_s_) + " s to " + shortest(frame.time_s) +
               " s");
    last_time_s_ = frame.time_s;
    ++rows_;
    return frame;
  }

  double value(std::string_view line, const Column &column, const Assigned &assigned) const {
    const std::size_t i = assigned.index;
    if (i >= cells_.size())
      fail(line.size() + 1, "the row ends before column " + std::to_string(i + 1) + ", " +
                                std::string(column.name));
    const auto number = parse_decimal(cells_[i].text, table_.decimal);
    if (!number)
      fail(cells_[i].column, (cells_[i].text.empty() ? "an empty cell" : excerpt(cells_[i].text)) +
                                 " is no number for " + std::string(column.name));
    const double value = assigned.value(*number);
    if (const std::string problem = value_problem(column, value); !problem.empty())
      fail(cells_[i].column, problem);
    return value;
  }

  /// The rate: given, or of the times in the head, or what stands before the rows.
  void choose_clock(const ImportOptions &options) {
    if (options.sample_rate_hz > 0.0) {
      rate_hz_ = options.sample_rate_hz;
      rate_from_ = "as given";
      return;
    }
    if (!columns_.time()) {
      rate_hz_ = table_.rate_hz.value_or(0.0);
      rate_from_ = "named before the rows";
      return;
    }
    const std::vector<double> times = head_times();
    rate_hz_ = regular_rate(times).value_or(0.0);
    rate_from_ = "from the times";
    for (std::size_t i = 1; i < times.size(); ++i)
      repeated_ += times[i] == times[i - 1];
  }

  /// As far as they can be read: what cannot is told when its row is.
  std::vector<double> head_times() {
    std::vector<double> times;
    for (std::size_t i = table_.first_row; i < head_.size(); ++i) {
      split_cells(head_[i], table_.separator, cells_);
      if (cells_.empty())
        continue;
      const std::size_t at = columns_.time()->index;
      const auto number =
          at < cells_.size() ? parse_decimal(cells_[at].text, table_.decimal) : std::nullopt;
      if (!number)
        break;
      times.push_back(columns_.time()->value(*number));
    }
    return times;
  }

  /// What would be metadata of a capture, in a file that does not begin as one.
  std::string unread_metadata() const {
    std::size_t first = 0, count = 0;
    for (std::size_t i = 0; i < table_.first_row; ++i)
      if (const std::string_view line = trim(head_[i]); line.starts_with('#'))
        if (const auto sign = line.find('=');
            sign != line.npos && is_known_metadata(trim(line.substr(1, sign - 1))))
          first = count++ == 0 ? i : first;
    if (count == 0)
      return {};
    return "not read: " + excerpt(trim(head_[first])) + " of line " + std::to_string(first + 1) +
           (count > 1 ? " and " + std::to_string(count - 1) + " more" : "") +
           "; metadata are read where the first line is '# ada4571-capture/1'\n";
  }

  void describe(const ImportOptions &options) {
    meta_.supply_v = options.supply_v;
    meta_.periods_per_turn = options.periods_per_turn;
    if (rate_hz_ > 0.0)
      meta_.sample_rate_hz = rate_hz_;
    text_ = "rows from line " + std::to_string(table_.first_row + 1) + ", separator " +
            quoted(table_.separator) + ", decimal mark '" + table_.decimal + "'\n" + columns_.text +
            unread_metadata();
    if (rate_hz_ > 0.0)
      text_ += "sample rate: " + shortest(rate_hz_) + " Hz, " + rate_from_ + "\n";
    else
      text_ += "sample rate: unknown, the times are not regular" +
               std::string(repeated_ > 0 ? "; some repeat, they have too few digits: give the rate"
                                         : "") +
               "\n";
  }

  Descriptor fd_;
  std::string shown_;
  LineReader lines_;
  std::vector<std::string> head_;
  bool head_ended_ = false;
  Table table_;
  Assignment columns_;
  std::vector<TextCell> cells_;
  std::size_t next_head_ = 0, line_ = 0, rows_ = 0, row_cells_ = 0, repeated_ = 0;
  double rate_hz_ = 0.0, last_time_s_ = 0.0;
  std::string rate_from_;
};

} // namespace

std::unique_ptr<Importer> open_text_import(Descriptor fd, const std::string &shown,
                                           const ImportOptions &options) {
  return std::make_unique<TextImport>(std::move(fd), shown, options);
}

} // namespace ada
