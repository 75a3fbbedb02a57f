// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The "key = value" pairs of a capture, the same in the text form and in SigMF.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "recording/capture.h"

namespace ada {

/// Sets the field that `key` names, or appends to `other`. Returns what is wrong with the pair in
/// one clause ("supply_v must be a number from 0.000001 to 100, not 'abc'"), empty when nothing
/// is. Giving a key twice is the caller's to refuse.
[[nodiscard]] std::string assign_metadata(CaptureMetadata &meta, std::string_view key,
                                          std::string_view value);

/// Whether the key is one of the format's own.
bool is_known_metadata(std::string_view key);

/// Every pair in the order in which it is written; numbers in the shortest form that reads back
/// to the same double.
std::vector<std::pair<std::string, std::string>> metadata_entries(const CaptureMetadata &meta);

/// Value of one key as it would be written.
std::optional<std::string> find_metadata(const CaptureMetadata &meta, std::string_view key);

/// What makes the known fields unfit to be written, empty when nothing does.
[[nodiscard]] std::string check_metadata(const CaptureMetadata &meta);

} // namespace ada
