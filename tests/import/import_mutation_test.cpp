// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Good files with a few bytes changed: the import refuses in one line, or what it gives keeps its
// promises.

#include <gtest/gtest.h>

#include <random>

#include "imported.h"
#include "support/seed.h"

using namespace ada;
using namespace ada::test;

namespace {

const std::string kFiles[] = {
    "Zeit;Sinus;Cosinus\n(ms);(V);(mV)\n\n-1,0;1,50;2500,0\n0,0;1,75;2250,0\n1,0;2,0;2000,0\n",
    "Sample Interval,1e-3\nTIME,sin,cos,ref (deg)\n0.0,1.5,2.5,9\n1e-3,1.75,2.25,8\n2e-3,2,2,7\n",
    std::string("\x93NUMPY\x01\0\x50\0", 10) +
        "{'descr': [('t','<f4'),('sin','<i2'),('cos','<u2')], 'fortran_order': False, 'shape': "
        "(2,)}\n" +
        std::string(16, '\x01')};

TEST(ImportMutation, BrokenFilesAreRefusedInOneLineOrKeepThePromises) {
  std::mt19937_64 rng(fresh_seed());
  const std::string trouble = ",;.\t \"\n\r\0-+e09{}()'<>|#%";
  for (int round = 0; round < 4000; ++round) {
    std::string file = kFiles[below(rng, std::size(kFiles))];
    for (auto changes = 1 + rng() % 4; changes > 0 && !file.empty(); --changes) {
      const std::size_t at = below(rng, file.size());
      if (rng() % 3 == 0)
        file.erase(at, 1 + below(rng, 5));
      else if (rng() % 2 == 0)
        file.insert(at, 1, trouble[below(rng, trouble.size())]);
      else
        file[at] = static_cast<char>(rng());
    }
    const Imported got = import_text(file);
    if (got.status != ADA4571_OK) {
      ASSERT_TRUE(got.status == ADA4571_ERROR_FORMAT ||
                  got.status == ADA4571_ERROR_INVALID_ARGUMENT)
          << got.error;
      ASSERT_EQ(got.error.find('\n'), std::string::npos) << got.error;
      ASSERT_FALSE(got.error.empty());
      continue;
    }
    for (std::size_t i = 0; i < got.frames.size(); ++i) {
      ASSERT_TRUE(std::isfinite(got.frames[i].vsin_v) && std::isfinite(got.frames[i].vcos_v));
      ASSERT_TRUE(i == 0 || got.frames[i].time_s >= got.frames[i - 1].time_s);
    }
  }
}

} // namespace
