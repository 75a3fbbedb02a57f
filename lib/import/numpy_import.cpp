// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/numpy_import.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/file_bytes.h"
#include "base/text.h"
#include "import/assignment.h"
#include "import/numpy_file.h"
#include "import/units.h"

namespace ada {

namespace {

/// More rows than that are samples, not channels.
constexpr std::size_t kMostChannels = 16;
constexpr std::size_t kTimesOfRate = 2000;

class NumpyImport final : public Importer {
public:
  NumpyImport(const std::string &path, const ImportOptions &options)
      : shown_(path), file_(path),
        array_(parse_numpy(file_.read(0, std::min(file_.size(), kNumpyHead)), file_.size(), path)) {
    lay_out();
    assignment_ = assign_columns(names_, options, path, options.sample_rate_hz > 0.0);
    channels_ = assignment_.set();
    rate_hz_ = options.sample_rate_hz;
    if (assignment_.time())
      rate_hz_ = regular_rate(first_times()).value_or(0.0);
    meta_.supply_v = options.supply_v;
    meta_.periods_per_turn = options.periods_per_turn;
    if (rate_hz_ > 0.0)
      meta_.sample_rate_hz = rate_hz_;
    text_ = std::to_string(rows_) + " samples" +
            (channels_in_rows_ ? ", the rows of the array are the channels" : "") + "\n" +
            assignment_.text + "sample rate: " +
            (rate_hz_ > 0.0 ? shortest(rate_hz_) + " Hz" : "unknown, the times are not regular") +
            "\n";
  }

  std::size_t read(std::span<Frame> out) override {
    std::size_t n = 0;
    for (; n < out.size() && row_ < rows_; ++n, ++row_)
      out[n] = next_frame();
    return n;
  }

private:
  /// Where the number of a row and a column lies.
  void lay_out() {
    const auto &shape = array_.shape;
    const bool records = !array_.fields.front().name.empty();
    if (records ? shape.size() != 1 : shape.size() != 2)
      throw Error(ADA4571_ERROR_FORMAT,
                  shown_ + ": an array of " + std::to_string(shape.size()) +
                      " dimensions cannot be imported: a table of rows and columns can, and a list "
                      "of records");
    rows_ = shape[0];
    if (records) {
      for (const NumpyField &field : array_.fields) {
        const NameAndUnit found = split_unit(field.name);
        names_.push_back({found.name, found.unit});
      }
      return;
    }
    std::size_t columns = shape[1];
    row_stride_ = array_.fortran_order ? 1 : shape[1];
    column_stride_ = array_.fortran_order ? shape[0] : 1;
    channels_in_rows_ = rows_ <= kMostChannels && columns > kMostChannels;
    if (channels_in_rows_) {
      std::swap(rows_, columns);
      std::swap(row_stride_, column_stride_);
    }
    if (columns > kMostChannels)
      throw Error(ADA4571_ERROR_FORMAT, shown_ + ": an array of " + std::to_string(shape[0]) +
                                            " times " + std::to_string(shape[1]) +
                                            " is no table of channels");
    names_.resize(columns);
  }

  double number(std::size_t row, std::size_t column) const {
    const bool records = !array_.fields.front().name.empty();
    const NumpyField &field = array_.fields[records ? column : 0];
    const std::size_t record = records ? row : row * row_stride_ + column * column_stride_;
    return numpy_number(field.type, bytes_at(column, array_.data_begin +
                                                         record * array_.record_bytes +
                                                         field.offset));
  }

  /// Numbers of a column lie one after the other or in rows: a part of the file for each column.
  const std::byte *bytes_at(std::size_t column, std::size_t place) const {
    constexpr std::size_t kPart = std::size_t{1} << 16, kLongestNumber = 8;
    Part &part = parts_[column];
    if (place < part.first || place + kLongestNumber > part.end) {
      part.first = place;
      part.end = std::min(file_.size(), place + kPart);
      part.bytes = file_.read(part.first, part.end - part.first);
    }
    const std::span<const std::byte> bytes = part.bytes;
    return bytes.data() + (place - part.first);
  }

  [[noreturn]] void fail(const Column &column, const std::string &what) const {
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ": sample " + std::to_string(row_) + ", " +
                                          std::string(column.name) + ": " + what);
  }

  Frame next_frame() {
    Frame frame = empty_frame();
    for (std::size_t c = 0; c < kColumns.size(); ++c)
      if (const auto &assigned = assignment_.channels[c]) {
        const double value = assigned->value(number(row_, assigned->index));
        if (!std::isfinite(value))
          fail(kColumns[c], "not a finite number");
        if (const std::string problem = value_problem(kColumns[c], value); !problem.empty())
          fail(kColumns[c], problem);
        frame.*kColumns[c].field = value;
      }
    if (!assignment_.time())
      frame.time_s = static_cast<double>(row_) / rate_hz_;
    else if (row_ > 0 && frame.time_s < last_time_s_)
      fail(kColumns[0], "the time goes back from " + shortest(last_time_s_) + " s to " +
                            shortest(frame.time_s) + " s");
    last_time_s_ = frame.time_s;
    return frame;
  }

  std::vector<double> first_times() const {
    std::vector<double> times;
    for (std::size_t i = 0; i < std::min(rows_, kTimesOfRate); ++i)
      times.push_back(assignment_.time()->value(number(i, assignment_.time()->index)));
    return times;
  }

  struct Part {
    std::size_t first = 0, end = 0;
    BytesRead bytes{{}};
  };

  std::string shown_;
  FileBytes file_;
  mutable std::map<std::size_t, Part> parts_; ///< one a column, as it was read last
  NumpyArray array_;
  std::vector<FileColumn> names_;
  Assignment assignment_;
  std::size_t rows_ = 0, row_ = 0;
  std::size_t row_stride_ = 1, column_stride_ = 1; ///< in numbers
  bool channels_in_rows_ = false;
  double rate_hz_ = 0.0, last_time_s_ = 0.0;
};

} // namespace

std::unique_ptr<Importer> open_numpy_import(const std::string &path,
                                            const ImportOptions &options) {
  return std::make_unique<NumpyImport>(path, options);
}

} // namespace ada
