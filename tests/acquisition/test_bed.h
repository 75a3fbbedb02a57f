// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A make-believe machine with IIO devices: a folder that looks like /sys and /dev, which the
// preloaded library of umockdev puts in the place of the real ones. The device node is a FIFO, so
// that a test plays the kernel: what it writes is what the capture reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace ada::test {

struct BedChannel {
  std::string id;                                  ///< "voltage0"
  std::string type;                                ///< "le:u16/16>>0"; empty: no scan element
  std::map<std::string, std::string> attributes{}; ///< "scale" -> "0.076"
};

struct BedDevice {
  std::string name = "fake-adc";
  std::vector<BedChannel> channels;
  std::map<std::string, std::string> attributes{}; ///< "sampling_frequency", "label", ...
};

/// Makes $UMOCKDEV_DIR for its life; umockdev's own test bed answers the ioctls (unknown to the
/// device, as with a FIFO of a real kernel). Tests that use it skip when the preload is not there.
class TestBed {
public:
  TestBed();
  ~TestBed();
  TestBed(const TestBed &) = delete;
  TestBed &operator=(const TestBed &) = delete;

  /// Whether this process runs under umockdev-wrapper.
  static bool available();

  /// Adds iio:deviceN and returns N.
  int add_device(const BedDevice &device);
  /// Adds a trigger called `name`.
  void add_trigger(const std::string &name, const std::map<std::string, std::string> &attributes);

  /// Folder of the device under the make-believe /sys, and its node under /dev.
  std::filesystem::path sysfs(int device = 0) const;
  std::filesystem::path node(int device = 0) const;

  std::string read(const std::string &attribute, int device = 0) const;
  void write(const std::string &attribute, const std::string &value, int device = 0);

  /// Unplugs: takes the folder away, as the kernel does.
  void remove_device(int device = 0);

  /// Opens the writing end of the node with room for a megabyte.
  void connect(int device = 0);
  /// Writes all bytes, waiting for room.
  void feed(std::span<const std::byte> bytes);

  const std::filesystem::path &root() const { return root_; }

private:
  void *bed_; ///< UMockdevTestbed
  std::filesystem::path root_;
  int devices_ = 0, triggers_ = 0;
  int feed_fd_ = -1;
};

/// Little-endian frames, element after element at their own alignment, for feed().
class FrameWriter {
public:
  FrameWriter &put(std::uint64_t value, unsigned bytes, bool big_endian = false);
  /// Ends a frame: pads to `alignment`.
  FrameWriter &end(unsigned alignment);
  std::span<const std::byte> bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

private:
  std::vector<std::byte> bytes_;
};

/// An ADC with labelled vsin, vcos, vtemp (u16, 0.1 mV a count) and timestamp; 16 bytes a frame.
BedDevice labelled_adc();

/// Frames of labelled_adc(): sin = first + i, cos = 2 * that, temp = 7, `period_ns` apart.
std::vector<std::byte> labelled_frames(std::size_t count, std::uint16_t first, std::int64_t time_ns,
                                       std::int64_t period_ns);

} // namespace ada::test
