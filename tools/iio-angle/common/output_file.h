// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A result file that appears whole or not at all; "-" is standard output.
#pragma once

#include <string>
#include <string_view>

namespace cli {

class OutputFile {
public:
  /// Writes beside `path` until commit(). What is there already and is no regular file (a pipe, a
  /// terminal, /dev/null) is written straight into.
  explicit OutputFile(const std::string &path);
  ~OutputFile();
  OutputFile(const OutputFile &) = delete;
  OutputFile &operator=(const OutputFile &) = delete;

  void write(std::string_view text);
  /// Makes the file appear under its name.
  void commit();

private:
  [[noreturn]] void fail(const char *what) const;

  std::string path_, temporary_; ///< temporary_ is empty when written straight
  int fd_ = -1;
};

} // namespace cli
