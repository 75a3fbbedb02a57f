// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a server says of its devices, looked at before libiio does, which waits for it for ever and
// prints what it finds wrong with it as it came.
#pragma once

#include <string>
#include <vector>

#include "acquisition/wake_up.h"

namespace ada {

/// A channel whose scan format this project cannot read, as the server has it.
struct OddFormat {
  std::string device, channel, format;
};

/// Nothing for a URI that is no network, and for a server whose name the system cannot resolve
/// (libiio may know how). Throws IO where the description never ends, is longer than any, or holds
/// control characters; DISCONNECTED where the server hangs. One that is not there at all is left to
/// libiio, as is one that does not know how to describe itself so. Returns what libiio would read
/// as something else (floating point as whole numbers).
std::vector<OddFormat> check_server_description(const std::string &uri,
                                                const Cancellation *cancellation);

} // namespace ada
