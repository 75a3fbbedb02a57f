// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Random tests draw a fresh seed and say which; ADA4571_TEST_SEED repeats a run.
#pragma once

#include <cstddef>
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

/// A whole number from 0 to n - 1, for places: a size has 32 bits on some processors.
template <class Random> std::size_t below(Random &random, std::size_t n) {
  return static_cast<std::size_t>(random() % n);
}

} // namespace ada::test
