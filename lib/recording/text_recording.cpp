// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_recording.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/parallel.h"
#include "recording/gap_detector.h"
#include "recording/identity.h"
#include "recording/rate_steps.h"
#include "recording/text_rows.h"

namespace ada {

namespace {

/// Bytes a block, to the next line.
constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
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
    text_ = {reinterpret_cast<const char *>(file_.bytes().data()), file_.bytes().size()};
    text_.remove_prefix(std::min(lines.bytes_read(), text_.size()));
    find_blocks();
    check_rows();
  }

  std::size_t blocks() const override { return begins_.size() - 1; }
  std::size_t block_begin(std::size_t block) const override {
    return first_rows_[std::min(block, blocks())];
  }

  void read(std::size_t block, std::size_t offset, std::size_t count, ColumnMask wanted,
            Block &out) const override {
    file_.check_holds(file_.bytes().size());
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
    LineReader lines(text_of(block, block + 1), shown_, 0);
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
    begins_.push_back(0);
    while (begins_.back() < text_.size()) {
      const std::size_t from = begins_.back() + kBlockBytes;
      const std::size_t line = from < text_.size() ? text_.find('\n', from) : text_.npos;
      begins_.push_back(line == text_.npos ? text_.size() : line + 1);
    }
  }

  std::string_view text_of(std::size_t block, std::size_t end) const {
    return text_.substr(begins_[block], begins_[end] - begins_[block]);
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
              explain(blank, k + 1);
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
      explain(0, blocks());
    facts_.gaps = steps.gaps();
    facts_.identity = columns.identity(channels_, size_);
  }

  void check_block(std::size_t k, Checked &out) const {
    clear(out.block);
    file_.check_holds(file_.bytes().size());
    try {
      LineReader lines(text_of(k, k + 1), shown_, 0);
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
    const std::string_view before = text_.substr(0, begins_[block]);
    const auto count = std::count(before.begin(), before.end(), '\n');
    LineReader lines(text_of(block, end), shown_, head_lines_ + static_cast<std::size_t>(count));
    TextRows::Store columns;
    const bool rows = rows_.read(lines, kAllColumns, kAllRows, columns).rows > 0;
    lines.fail(1, rows ? kChanges : "there is no row after the header line");
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
  MappedFile file_;
  TextRows rows_;
  std::size_t head_lines_ = 0;
  std::string_view text_;               ///< the rows
  std::vector<std::size_t> begins_;     ///< of the blocks in it, and its end
  std::vector<std::size_t> first_rows_; ///< of the blocks, and the number of rows
  std::vector<std::size_t> jumps_;
};

} // namespace

std::shared_ptr<const Recording> text_recording(int fd, const std::string &shown) {
  return std::make_shared<TextRecording>(fd, shown);
}

} // namespace ada
