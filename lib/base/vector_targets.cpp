// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Highway before 1.0.4 counts AES in with NEON. On an Arm processor without it, that of a Raspberry
// Pi 3 or 4 for one, it writes a warning to standard error and takes nothing for supported. Nothing
// here uses AES; so it is told before it looks that NEON is there, which on 64-bit Arm it always is.

#include "base/vector_targets.h"

#include <hwy/highway.h>

#if HWY_ARCH_ARM_A64 && !defined(HWY_NEON_WITHOUT_AES) && defined(__linux__)
#include <sys/auxv.h>

namespace ada {

std::int64_t told_targets() {
  return (getauxval(AT_HWCAP) & HWCAP_AES) != 0 ? 0 : HWY_NEON;
}

namespace {
[[maybe_unused]] const bool told = [] {
  if (told_targets() != 0)
    hwy::SetSupportedTargetsForTest(told_targets());
  return true;
}();
} // namespace

} // namespace ada
#else
std::int64_t ada::told_targets() {
  return 0;
}
#endif
