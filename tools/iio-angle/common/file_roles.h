// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The files that a verb reads and those that it writes: none is both, and none is written twice,
// whatever links and names lead to it.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

#include "common/handles.h"

namespace cli {

/// A capture, a model or another file to read. Throws Failure(kWrongUsage), before anything is
/// read or said, where the shell has opened it for standard output or standard error, which would
/// write into it (`>>FILE`, `1<>FILE`).
Recording open_capture(const std::string &path);
Model load_model(const std::string &path);
void refuse_redirection_into(const std::string &path);
/// For a command line that is wrong, of which nobody knows what its words are: what is said of it
/// does not go into a file that one of them names.
void keep_remarks_out_of(const std::vector<std::string> &words);

class FileRoles {
public:
  /// "-" is standard input; an empty path, of an option that was not given, is nothing. A SigMF
  /// recording is its two files. Call reads() before writes().
  FileRoles &reads(const std::string &path);
  /// The data file too, which a meta file may name otherwise (core:dataset).
  FileRoles &reads(const std::string &path, const Recording &recording);
  /// Throws Failure(kWrongUsage) for one that is read already: the same samples again are no
  /// further evidence, and none at all where they are to judge what was fitted to them.
  FileRoles &reads_once(const std::string &path, const Recording &recording);
  /// Throws Failure(kWrongUsage) when that would write over a file that is read or written already,
  /// or to standard output a second time; Failure(kUnusable) when no file can be written there:
  /// before the work, not after it.
  FileRoles &writes(const std::string &path);

private:
  struct Known {
    std::string path;
    dev_t device;
    ino_t inode; ///< 0 when there is no such file yet: then the path must do
    bool written;
    bool is(const Known &other) const;
  };
  void add(const std::string &path, bool written);

  std::vector<Known> known_;
  bool standard_output_ = false; ///< one of them is written there
};

} // namespace cli
