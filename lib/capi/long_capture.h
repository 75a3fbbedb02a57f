// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Long recordings for a diagnosis, which holds what it looks at in memory: of each one stretches
// from everywhere, and, of all of it, what happens rarely.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "capi/handles.h"

namespace ada::capi {

/// What was looked at of the recordings of one diagnosis.
class LookedAt {
public:
  /// All of a recording up to a million samples; of a longer one as many in 32 stretches.
  std::shared_ptr<const Capture> part_of(const ada4571_recording &handle);

  /// A sentence for each long recording, to stand after the result; empty where all are short.
  std::string text() const;
  /// The result with a key "looked_at" beside its own.
  std::string with_json(const std::string &json) const;

private:
  struct Long {
    std::size_t samples, of_samples, stretches;
    std::string spikes, gaps; ///< in all of it
  };
  std::vector<Long> long_;
};

} // namespace ada::capi
