// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The two files of a SigMF recording as a unit. A rename replaces one file, so two of them leave a
// moment in which one is old and one is new. Here the meta file decides: it is put in place with
// the data file still under a name of its own, which it states (core:dataset); only then the data
// file takes the usual name. A program that is killed anywhere on the way leaves the old recording
// or the new one, and beside it at most a file NAME.NUMBER.sigmf-data that nobody refers to.
#pragma once

#include <string>

#include "base/descriptor.h"
#include "recording/sigmf_meta.h"

namespace ada {

/// Before the work: throws Error(ADA4571_ERROR_INVALID_ARGUMENT) where links would put the two
/// files of a new recording apart, Error(ADA4571_ERROR_BUSY) when another program is recording
/// there. The old data file, locked against a second writer as long as this is open; none where
/// there is none. `path` names either file.
Descriptor claim_sigmf_pair(const std::string &path);

/// Writes the meta file whole or not at all.
void write_sigmf_meta(const SigmfMeta &meta, const std::string &meta_path);

/// A name beside the recording's that nobody has: NAME.NUMBER, without the end.
std::string free_sigmf_stem(const std::string &path);

/// What becomes of the data file when nothing could be changed.
enum class IfRefused { keep, remove };

/// `path` names either file of the recording; `data` is the data file, on the disk and in the same
/// folder, which is renamed. Throws Error(ADA4571_ERROR_BUSY) when another program is recording
/// there, who holds `claim` excepted; the recording of that name is the old one or the new one,
/// whatever happens.
void publish_sigmf_pair(const std::string &path, SigmfMeta meta, const std::string &data,
                        IfRefused refused, const Descriptor &claim = Descriptor());

/// Locks a file against a second writer until it is closed; false when it has one.
bool lock_for_writing(int fd) noexcept;

} // namespace ada
