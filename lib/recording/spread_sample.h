// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <memory>

#include "recording/recording.h"

namespace ada {

/// The recording itself where it holds no more than `most` samples; else stretches of
/// `stretch` neighbouring samples, `most` in all, one from each of as many equal parts of the
/// recording, at a place within its part that looks random and is always the same: nothing that
/// repeats can hide between them. Between stretches samples are missing, which `gaps` says.
/// `named`: with the identity of the recording, which is a pass over it.
std::shared_ptr<const Capture> spread_sample(const Recording &recording, std::size_t most,
                                             std::size_t stretch, bool named = false);

/// Sample of a recording of `size` samples at a place of such a selection of it.
std::size_t sample_place(std::size_t size, std::size_t most, std::size_t stretch,
                         std::size_t place);

} // namespace ada
