// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ada {

/// Lines without their end (LF or CRLF): of a descriptor, from a buffer of fixed size, or of a text
/// in memory, in place.
class LineReader {
public:
  /// Longest line that is read; a longer one is an error rather than an allocation.
  static constexpr std::size_t kMaxLine = std::size_t{1} << 16;

  LineReader(int fd, std::string shown);
  /// `lines_before` the text count in what fail() says.
  LineReader(std::string_view text, std::string shown, std::size_t lines_before);

  /// False at the end of the file. `line` is good until the next call.
  bool next(std::string_view &line);

  /// What is in memory behind the lines so far; it may end anywhere in a line.
  std::string_view ahead() const { return {text_ + begin_, end_ - begin_}; }
  /// Takes the next line for read, which ends before `behind`, a place of ahead().
  void skip_line(const char *behind) {
    const auto bytes = static_cast<std::size_t>(behind - (text_ + begin_));
    begin_ += bytes;
    consumed_ += bytes;
    ++line_number_;
  }

  std::size_t line_number() const { return line_number_; } ///< of the last line, from 1
  std::size_t bytes_read() const { return consumed_; }     ///< by the lines so far

  /// Error(ADA4571_ERROR_FORMAT) "file:line:column: what"; columns count from 1.
  [[noreturn]] void fail(std::size_t column, const std::string &what) const;

private:
  bool fill();

  int fd_;
  std::string shown_;
  std::vector<char> buffer_;
  const char *text_;                ///< the buffer, or the text in memory
  std::size_t begin_ = 0, end_ = 0; ///< unread part of it
  std::size_t line_number_ = 0, consumed_ = 0;
  bool at_end_ = false;
};

} // namespace ada
