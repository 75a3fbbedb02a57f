// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "import/importer.h"

namespace ada {

/// An array of records, or of numbers in rows and columns; where it is wider than long by far, its
/// rows are the channels.
std::unique_ptr<Importer> open_numpy_import(const std::string &path, const ImportOptions &options);

} // namespace ada
