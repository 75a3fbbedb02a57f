// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_reader.h"

#include <algorithm>
#include <utility>

#include "base/descriptor.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "recording/sigmf_recording.h"

namespace ada {

namespace {

std::string with_end(const std::string &path, std::string_view end) {
  return path.substr(0, path.rfind('.')) + std::string(end);
}

} // namespace

bool is_sigmf(std::string_view path) {
  return path.ends_with(".sigmf-meta") || path.ends_with(".sigmf-data");
}

std::size_t whole_frames(const SigmfMeta &meta, const FileBytes &data) {
  constexpr std::size_t kAtOnce = 4096; // frames
  std::size_t count = data.size() / meta.frame_bytes;
  while (meta.unfinished && count > 0) {
    const std::size_t some = std::min(count, kAtOnce);
    const BytesRead read = data.read((count - some) * meta.frame_bytes, some * meta.frame_bytes);
    const std::span<const std::byte> bytes = read;
    const auto last = std::find_if(bytes.rbegin(), bytes.rend(),
                                   [](std::byte b) { return b != std::byte{}; });
    const std::size_t blank = static_cast<std::size_t>(last - bytes.rbegin()) / meta.frame_bytes;
    count -= blank;
    if (blank < some)
      break;
  }
  return count;
}

std::string sigmf_meta_path(const std::string &path) {
  return with_end(path, ".sigmf-meta");
}
std::string sigmf_data_path(const std::string &path) {
  return with_end(path, ".sigmf-data");
}

SigmfMeta read_sigmf_meta(const std::string &meta_path) {
  const FileBytes json(meta_path);
  if (json.size() > kMaxSigmfMetaBytes)
    throw Error(ADA4571_ERROR_FORMAT, meta_path + ":1:1: the meta file is longer than " +
                                          std::to_string(kMaxSigmfMetaBytes) + " bytes");
  const BytesRead read = json.all();
  const std::span<const std::byte> bytes = read;
  return parse_sigmf_meta({reinterpret_cast<const char *>(bytes.data()), bytes.size()}, meta_path);
}

namespace {

/// A data file that is not there under the name that the meta file states has got the usual name in
/// the meantime; the checksum tells whether it is the one.
std::string data_path_of(const SigmfMeta &meta, const std::string &path) {
  const std::string usual = sigmf_data_path(path);
  if (meta.dataset.empty())
    return usual;
  const std::string stated = usual.substr(0, usual.rfind('/') + 1) + meta.dataset;
  return meta.data_crc32 && !file_id(stated) && file_id(usual) ? usual : stated;
}

/// Tells a file from the one that took its place, which may have got its inode.
struct Version {
  FileId id;
  std::int64_t written_s = 0, written_ns = 0;
  bool operator==(const Version &) const = default;
};

Version version_of(const std::string &path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0)
    return {};
  return {{info.st_dev, info.st_ino}, info.st_mtim.tv_sec, info.st_mtim.tv_nsec};
}

} // namespace

std::shared_ptr<const Recording> open_sigmf_recording(const std::string &path) {
  const std::string meta_path = sigmf_meta_path(path);
  // Another program may replace the recording between its two files, again and again.
  constexpr int kTries = 64, kTriesOfOne = 4;
  for (int i = 1;; ++i) {
    const Version before = version_of(meta_path);
    const SigmfMeta meta = read_sigmf_meta(meta_path);
    const std::string data_path = data_path_of(meta, path);
    try {
      return sigmf_recording(meta, FileBytes(data_path), data_path);
    } catch (const Error &) {
      // A meta file of the same moment may look like the one before it: a few tries all the same.
      if (i == kTries || (i >= kTriesOfOne && version_of(meta_path) == before))
        throw;
    }
  }
}

} // namespace ada
