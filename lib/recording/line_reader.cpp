// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/line_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <unistd.h>

#include "base/descriptor.h"

namespace ada {

LineReader::LineReader(int fd, std::string shown)
    : fd_(fd), shown_(std::move(shown)), buffer_(16 * kMaxLine), text_(buffer_.data()) {}

LineReader::LineReader(std::string_view text, std::string shown, std::size_t lines_before)
    : fd_(-1), shown_(std::move(shown)), text_(text.data()), end_(text.size()),
      line_number_(lines_before), at_end_(true) {}

void LineReader::fail(std::size_t column, const std::string &what) const {
  throw Error(ADA4571_ERROR_FORMAT, shown_ + ":" +
                                        std::to_string(std::max<std::size_t>(line_number_, 1)) +
                                        ":" + std::to_string(column) + ": " + what);
}

/// Moves the unread part to the front and reads behind it; false when nothing more comes.
bool LineReader::fill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  while (true) {
    const ssize_t count = ::read(fd_, buffer_.data() + end_, buffer_.size() - end_);
    if (count < 0 && errno == EINTR)
      continue;
    if (count < 0)
      throw system_error(errno, shown_, "cannot read");
    end_ += static_cast<std::size_t>(count);
    return count > 0;
  }
}

bool LineReader::next(std::string_view &line) {
  std::size_t searched = 0;
  while (true) {
    const char *start = text_ + begin_;
    const auto *newline =
        static_cast<const char *>(std::memchr(start + searched, '\n', end_ - begin_ - searched));
    if (newline != nullptr || (at_end_ && begin_ < end_)) {
      const char *stop = newline ? newline : text_ + end_;
      line = {start, static_cast<std::size_t>(stop - start)};
      consumed_ += line.size() + 1;
      begin_ += line.size() + (newline ? 1 : 0);
      ++line_number_;
      if (line.size() > kMaxLine)
        break;
      if (!line.empty() && line.back() == '\r')
        line.remove_suffix(1);
      return true;
    }
    if (at_end_)
      return false;
    searched = end_ - begin_;
    if (searched > kMaxLine) {
      ++line_number_;
      break;
    }
    at_end_ = !fill();
  }
  fail(1, "the line is longer than " + std::to_string(kMaxLine) + " bytes");
}

} // namespace ada
