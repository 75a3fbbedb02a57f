// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_recording.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/file_bytes.h"
#include "base/parallel.h"
#include "recording/gap_detector.h"
#include "recording/identity.h"
#include "recording/rate_steps.h"
#include "recording/text_rows.h"

namespace ada {

namespace {

/// Bytes a block, to the next line.
constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
constexpr std::size_t kLookedThrough = 4096; ///< bytes at once, for the end of a line
constexpr const char *kChanges = "the file changes while it is read";
constexpr std::size_t kAllRows = std::numeric_limits<std::size_t>::max();

class TextRecording final : public Recording {
public:
  TextRecording(int fd, const std::string &shown) : shown_(shown), file_(fd, shown) {
    LineReader lines(fd, shown);
    TextHead head = read_text_head(lines);
    head_lines_ = lines.line_number();
    rows_ = std::move(head.rows);
    facts_.meta = std::move(head.meta);
    facts_.ignored_columns = std::move(head.ignored_columns);
    channels_ = rows_.channels();
    begins_.push_back(std::min(lines.bytes_read(), file_.size()));
    find_blocks();
    check_rows();
  }

  std::size_t blocks() const override { return begins_.size() - 1; }
  std::size_t block_begin(std::size_t block) const override {
    return first_rows_[std::min(block, blocks())];
  }

  void read(std::size_t block, std::size_t offset, std::size_t count, ColumnMask wanted,
            Block &out) const override {
    clear(out);
    const std::size_t end = first_rows_[block + 1];
    out.first = std::min(first_rows_[block] + offset, end);
    out.count = std::min(count, end - out.first);
    if (!read_rows(block, out.first - first_rows_[block], out.count, wanted, out.store))
      throw Error(ADA4571_ERROR_FORMAT, shown_ + ": " + kChanges);
    show(out);
  }

  const std::vector<std::size_t> &jumps() const override { return jumps_; }

private:
  struct Checked {
    Block block;
    TextRows::Count found;
    ColumnSums columns;
  };

  /// What was sound when the file was opened; false where it no longer is.
  bool read_rows(std::size_t block, std::size_t skipped, std::size_t count, ColumnMask wanted,
                 TextRows::Store &out) const {
    const BytesRead bytes = bytes_of(block, block + 1);
    LineReader lines(text(bytes), shown_, 0);
    try {
      return rows_.read(lines, 0, skipped, out).rows == skipped &&
             rows_.read(lines, wanted, count, out).rows == count;
    } catch (const Error &) {
      return false;
    }
  }

  static void clear(Block &block) {
    for (std::vector<double> &column : block.store)
      column.clear();
  }
  static void show(Block &block) {
    for (std::size_t c = 0; c < kColumns.size(); ++c)
      block.*kColumns[c].block = block.store[c];
  }

  void find_blocks() {
    while (begins_.back() < file_.size())
      begins_.push_back(line_after(begins_.back() + kBlockBytes));
  }

  /// Where the first line begins that begins after a place; the end of the file where none does.
  std::size_t line_after(std::size_t place) const {
    while (place < file_.size()) {
      const std::size_t some = std::min(file_.size() - place, kLookedThrough);
      const BytesRead bytes = file_.read(place, some);
      const std::size_t end = text(bytes).find('\n');
      if (end != std::string_view::npos)
        return place + end + 1;
      place += some;
    }
    return file_.size();
  }

  BytesRead bytes_of(std::size_t block, std::size_t end) const {
    return file_.read(begins_[block], begins_[end] - begins_[block]);
  }
  static std::string_view text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char *>(bytes.data()), bytes.size()};
  }

  std::size_t lines_before(std::size_t block) const {
    std::size_t lines = head_lines_;
    for (std::size_t k = 0; k < block; ++k) {
      const BytesRead bytes = bytes_of(k, k + 1);
      lines += static_cast<std::size_t>(std::count(text(bytes).begin(), text(bytes).end(), '\n'));
    }
    return lines;
  }

  void check_rows() {
    first_rows_.push_back(0);
    std::size_t blank = blocks(), last = 0; // first block with an empty line, last one with rows
    GapDetector jump;
    RateSteps steps(facts_.meta.sample_rate_hz);
    ColumnSums columns;
    in_order<Checked>(
        blocks(), [this](std::size_t k, Checked &c) { check_block(k, c); },
        [&](std::size_t k, const Checked &c) {
          if (c.found.rows > 0) {
            if (blank < k)
              explain_blank(blank, k);
            if (size_ > 0 && c.block.time_s.front() < last_time_s_)
              explain(last, k + 1);
            join_times(c.block, jump, steps);
            last = k;
          }
          if (c.found.blank_line && blank == blocks())
            blank = k;
          columns.append(c.columns);
          size_ += c.found.rows;
          first_rows_.push_back(size_);
        });
    if (size_ == 0)
      explain_no_rows();
    facts_.gaps = steps.gaps();
    facts_.identity = columns.identity(channels_, size_);
  }

  void check_block(std::size_t k, Checked &out) const {
    clear(out.block);
    const BytesRead bytes = bytes_of(k, k + 1);
    try {
      LineReader lines(text(bytes), shown_, 0);
      out.found = rows_.read(lines, kAllColumns, kAllRows, out.block.store);
    } catch (const Error &) {
      explain(k, k + 1);
    }
    show(out.block);
    out.block.count = out.found.rows;
    out.columns = ColumnSums(out.block, facts_.meta);
  }

  /// Reads these blocks again to say what is wrong with them, in its place.
  [[noreturn]] void explain(std::size_t block, std::size_t end) const {
    const BytesRead bytes = bytes_of(block, end);
    LineReader lines(text(bytes), shown_, lines_before(block));
    TextRows::Store columns;
    rows_.read(lines, kAllColumns, kAllRows, columns);
    lines.fail(1, kChanges);
  }

  /// A block with rows after one with an empty line; there may be any number between them.
  [[noreturn]] void explain_blank(std::size_t blank, std::size_t block) const {
    const BytesRead before = bytes_of(blank, blank + 1), after = bytes_of(block, block + 1);
    LineReader lines_until(text(before), shown_, lines_before(blank));
    LineReader lines(text(after), shown_, lines_before(block));
    TextRows::Store columns;
    const TextRows::Count until = rows_.read(lines_until, 0, kAllRows, columns);
    rows_.read(lines, 0, kAllRows, columns, until.blank_line);
    lines.fail(1, kChanges);
  }

  [[noreturn]] void explain_no_rows() const {
    LineReader({}, shown_, lines_before(blocks())).fail(1, "there is no row after the header line");
  }

  void join_times(const Block &block, GapDetector &jump, RateSteps &steps) {
    if (size_ == 0)
      first_time_s_ = last_time_s_ = block.time_s.front();
    for (std::size_t i = 0; i < block.count; ++i) {
      if (jump(block.time_s[i]))
        jumps_.push_back(size_ + i);
      steps.add(size_ + i, block.time_s[i] - last_time_s_);
      last_time_s_ = block.time_s[i];
    }
  }

  std::string shown_;
  FileBytes file_;
  TextRows rows_;
  std::size_t head_lines_ = 0;
  std::vector<std::size_t> begins_;     ///< of the blocks in the file, and its end
  std::vector<std::size_t> first_rows_; ///< of the blocks, and the number of rows
  std::vector<std::size_t> jumps_;
};

} // namespace

std::shared_ptr<const Recording> text_recording(int fd, const std::string &shown) {
  return std::make_shared<TextRecording>(fd, shown);
}

} // namespace ada
