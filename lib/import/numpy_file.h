// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The .npy format of numpy, versions 1 to 3: magic, version, length and text of a Python dictionary,
// then the numbers (numpy.lib.format).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ada {

inline constexpr std::string_view kNumpyMagic = "\x93NUMPY";

/// A number of an array: "<f8", ">i2", "|u1".
struct NumpyType {
  char kind = 'f'; ///< f, i or u
  std::size_t bytes = 8;
  bool big_endian = false;
};

struct NumpyField {
  std::string name; ///< empty where the array has no fields
  NumpyType type;
  std::size_t offset = 0; ///< in a record
};

struct NumpyArray {
  std::vector<NumpyField> fields; ///< one without a name for an array of plain numbers
  std::size_t record_bytes = 0;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
  std::size_t data_begin = 0; ///< in the file
};

/// From the first kNumpyHead bytes of a file, or all that it has. Throws FORMAT with the place; the
/// data are all there.
inline constexpr std::size_t kNumpyHead = (std::size_t{1} << 16) + 12;
NumpyArray parse_numpy(std::span<const std::byte> head, std::size_t file_bytes,
                       const std::string &shown);

double numpy_number(const NumpyType &type, const std::byte *at);

} // namespace ada
