// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <memory>

#include "base/atomic_file.h"
#include "capi/guard.h"

struct ada4571_file {
  std::unique_ptr<ada::AtomicFile> impl; ///< null once committed, or after a failed write
};

namespace {

using ada::capi::guard;
using ada::capi::require;

ada::AtomicFile &open_file(ada4571_file *file) {
  require(file, "file");
  if (!file->impl)
    throw ada::Error(ADA4571_ERROR_STATE, "the file is already complete, or its writing failed");
  return *file->impl;
}

} // namespace

extern "C" {

ada4571_status ada4571_file_open(const char *path, ada4571_file **file) {
  return guard([&] {
    require(path, "path");
    require(file, "file");
    *file = new ada4571_file{std::make_unique<ada::AtomicFile>(path)};
  });
}

ada4571_status ada4571_file_write(ada4571_file *file, const char *bytes, size_t count) {
  return guard([&] {
    ada::AtomicFile &impl = open_file(file);
    if (count > 0)
      require(bytes, "bytes");
    try {
      impl.write(bytes, count);
    } catch (...) {
      file->impl.reset(); // a file with a part missing must not appear, whatever comes next
      throw;
    }
  });
}

ada4571_status ada4571_file_commit(ada4571_file *file) {
  return guard([&] {
    open_file(file).commit();
    file->impl.reset();
  });
}

void ada4571_file_free(ada4571_file *file) {
  delete file;
}

} // extern "C"
