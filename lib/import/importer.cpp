// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/importer.h"

#include <array>
#include <cerrno>
#include <cmath>
#include <string_view>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/text.h"
#include "import/numpy_file.h"
#include "import/numpy_import.h"
#include "import/text_import.h"

namespace ada {

namespace {

void check(const ImportOptions &options) {
  const auto refuse = [](const std::string &why) {
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, why);
  };
  if (options.separator && std::string_view(",;|\t ").find(*options.separator) == std::string_view::npos)
    refuse("the separator must be a comma, a semicolon, a bar, a tab or a blank");
  if (options.decimal && *options.decimal != '.' && *options.decimal != ',')
    refuse("the decimal mark must be a point or a comma");
  if (options.separator && options.separator == options.decimal)
    refuse("separator and decimal mark must differ: give another --separator or --decimal");
  if (!(options.sample_rate_hz >= 0.0 && options.sample_rate_hz <= 1e9))
    refuse("the sample rate must be from 0 to 1e9");
  for (const ImportColumn &column : options.columns)
    if ((column.scale && (!std::isfinite(*column.scale) || *column.scale == 0.0)) ||
        !std::isfinite(column.offset))
      refuse("a scale must be a finite number other than 0, an offset a finite number");
  if (options.sample_rate_hz > 0.0 && options.columns[0].column && !options.columns[0].column->empty())
    refuse("the times come from a column or from the sample rate, not from both");
}

/// The first bytes of a regular file, which stays where it is.
bool begins_as_numpy(int fd) {
  std::array<char, kNumpyMagic.size()> bytes{};
  return ::pread(fd, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()) &&
         std::string_view(bytes.data(), bytes.size()) == kNumpyMagic;
}

} // namespace

std::unique_ptr<Importer> open_import(const std::string &path, const ImportOptions &options) {
  check(options);
  const bool standard_input = path == "-";
  Descriptor fd(standard_input ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)
                               : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (fd.get() < 0)
    throw system_error(errno, path, "cannot open");
  if (!standard_input && begins_as_numpy(fd.get()))
    return open_numpy_import(path, options);
  return open_text_import(std::move(fd), standard_input ? "standard input" : path, options);
}

} // namespace ada
