// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "base/descriptor.h"
#include "import/importer.h"

namespace ada {

/// Reads the descriptor from where it stands.
std::unique_ptr<Importer> open_text_import(Descriptor fd, const std::string &shown,
                                           const ImportOptions &options);

} // namespace ada
