// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A file of another program, imported.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "import/importer.h"
#include "support/temp_folder.h"

namespace ada::test {

struct Imported {
  std::vector<Frame> frames;
  CaptureMetadata meta;
  ChannelSet channels;
  std::string text, error; ///< `error` without the folder
  ada4571_status status = ADA4571_OK;
};

/// Reads `block` frames at a time.
inline Imported import_text(std::string_view content, const ImportOptions &options = {},
                            std::size_t block = 7) {
  const TempFolder folder;
  const std::string path = folder / "file";
  write_file(path, content);
  Imported out;
  try {
    const auto import = open_import(path, options);
    out.meta = import->meta();
    out.channels = import->channels();
    out.text = import->text();
    std::vector<Frame> frames(block);
    while (const std::size_t n = import->read(frames))
      out.frames.insert(out.frames.end(), frames.begin(),
                        frames.begin() + static_cast<std::ptrdiff_t>(n));
  } catch (const Error &e) {
    out.status = e.status();
    out.error = e.what();
    if (const auto at = out.error.find(path); at != out.error.npos)
      out.error.replace(at, path.size(), "file");
  }
  return out;
}

/// Columns of VSIN and VCOS.
inline ImportOptions pair(const std::string &sin, const std::string &cos) {
  ImportOptions options;
  options.columns[1].column = sin;
  options.columns[2].column = cos;
  return options;
}

} // namespace ada::test
