// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One libFuzzer program; FUZZED names the function of parsers.h.

#include <cstddef>
#include <cstdint>

#include "parsers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  ada::test::FUZZED({reinterpret_cast<const char *>(data), size});
  return 0;
}
