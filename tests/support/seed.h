// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Random tests draw a fresh seed and say which; ADA4571_TEST_SEED repeats a run.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace ada::test {

inline std::uint64_t fresh_seed() {
  std::uint64_t seed;
  if (const char *fixed = std::getenv("ADA4571_TEST_SEED"))
    seed = std::strtoull(fixed, nullptr, 0);
  else
    seed = (std::uint64_t{std::random_device{}()} << 32) | std::random_device{}();
  std::printf("ADA4571_TEST_SEED=%llu\n", static_cast<unsigned long long>(seed));
  std::fflush(stdout);
  return seed;
}

} // namespace ada::test
