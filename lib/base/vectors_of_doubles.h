// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Before Highway's headers in a file whose vectors hold doubles: NEON of 32 bits has none, and such
// a file goes without vectors there.
#pragma once

#if defined(__arm__)
#define HWY_DISABLED_TARGETS HWY_NEON
#endif
