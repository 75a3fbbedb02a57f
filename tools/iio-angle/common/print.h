// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The one place for what the program says: results on standard output, where a failed write is a
// failure of the program, and remarks on standard error, where it is none.
#pragma once

#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

namespace cli {

/// To be called first: descriptors 0, 1 and 2 are open, be it /dev/null, so that no file that is
/// opened later takes their place and gets what is printed; a closed pipe is a failed write.
void open_standard_descriptors();

/// Writes to standard output at once. Throws Failure, also where its reader has gone (`| head`).
void put(std::string_view text);

/// Whatever libraries left in their buffers goes out, or fails as put() does.
void flush_output();

/// Where remarks go from now on, instead of to standard error; nowhere for -1.
void remark_to(int fd) noexcept;

/// Standard error; a failure is not said, for there is no place left to say it.
void remark(std::string_view text) noexcept;

template <class... Arguments>
void print(fmt::format_string<Arguments...> format, Arguments &&...arguments) {
  put(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// `text` without power over a terminal: what controls one as \n or \xNN. Names of files are given
/// by others.
std::string plain(std::string_view text);

/// What note() prints of an argument: text is plain.
template <class Argument> auto plain_argument(const Argument &argument) {
  if constexpr (std::is_convertible_v<const Argument &, std::string_view>)
    return plain(argument);
  else
    return argument;
}

/// A remark; its arguments stay on the line, its format says where one ends.
template <class... Arguments>
void note(fmt::format_string<Arguments...> format, const Arguments &...arguments) {
  std::apply(
      [format](const auto &...plain) {
        remark(fmt::vformat(format, fmt::make_format_args(plain...)));
      },
      std::make_tuple(plain_argument(arguments)...));
}

} // namespace cli
