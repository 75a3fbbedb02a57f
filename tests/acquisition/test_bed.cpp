// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "test_bed.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

namespace ada::test {

namespace fs = std::filesystem;

namespace {

void put_file(const fs::path &path, const std::string &value) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << value << '\n'; // libiio cuts the last character
}

} // namespace

bool TestBed::available() {
  const char *preload = std::getenv("LD_PRELOAD");
  return preload && std::strstr(preload, "libumockdev-preload");
}

TestBed::TestBed() : bed_(umockdev_testbed_new()) {
  gchar *root = umockdev_testbed_get_root_dir(static_cast<UMockdevTestbed *>(bed_));
  root_ = root;
  g_free(root);
  fs::create_directories(root_ / "sys/bus/iio/devices");
  fs::create_directories(root_ / "dev");
}

TestBed::~TestBed() {
  if (feed_fd_ >= 0)
    close(feed_fd_);
  g_object_unref(bed_); // removes the folder
}

fs::path TestBed::sysfs(int device) const {
  return root_ / "sys/bus/iio/devices" / ("iio:device" + std::to_string(device));
}
fs::path TestBed::node(int device) const {
  return root_ / "dev" / ("iio:device" + std::to_string(device));
}

int TestBed::add_device(const BedDevice &device) {
  const int n = devices_++;
  put_file(sysfs(n) / "name", device.name);
  for (const auto &[name, value] : device.attributes)
    put_file(sysfs(n) / name, value);
  put_file(sysfs(n) / "buffer/length", "0");
  put_file(sysfs(n) / "buffer/enable", "0");
  put_file(sysfs(n) / "buffer/watermark", "1");
  put_file(sysfs(n) / "trigger/current_trigger", "");
  int index = 0;
  for (const BedChannel &channel : device.channels) {
    for (const auto &[name, value] : channel.attributes)
      put_file(sysfs(n) / ("in_" + channel.id + "_" + name), value);
    if (channel.type.empty())
      continue;
    const std::string element = "scan_elements/in_" + channel.id;
    put_file(sysfs(n) / (element + "_type"), channel.type);
    put_file(sysfs(n) / (element + "_en"), "0");
    put_file(sysfs(n) / (element + "_index"), std::to_string(index++));
  }
  if (mkfifo(node(n).c_str(), 0666) != 0)
    throw std::runtime_error("mkfifo");
  return n;
}

void TestBed::add_trigger(const std::string &name,
                          const std::map<std::string, std::string> &attributes) {
  const fs::path folder = root_ / "sys/bus/iio/devices" / ("trigger" + std::to_string(triggers_++));
  put_file(folder / "name", name);
  for (const auto &[key, value] : attributes)
    put_file(folder / key, value);
}

std::string TestBed::read(const std::string &attribute, int device) const {
  std::ifstream file(sysfs(device) / attribute);
  std::string value;
  std::getline(file, value);
  while (!value.empty() && value.back() == '\0') // libiio writes the terminator too
    value.pop_back();
  return value;
}

void TestBed::write(const std::string &attribute, const std::string &value, int device) {
  put_file(sysfs(device) / attribute, value);
}

void TestBed::remove_device(int device) {
  fs::remove_all(sysfs(device));
}

void TestBed::connect(int device) {
  feed_fd_ = open(node(device).c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (feed_fd_ < 0)
    throw std::runtime_error("open FIFO");
  (void)!fcntl(feed_fd_, F_SETPIPE_SZ, 1 << 20);
}

void TestBed::feed(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(feed_fd_, bytes.data(), bytes.size());
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else {
      pollfd p{feed_fd_, POLLOUT, 0};
      (void)!poll(&p, 1, 1000);
    }
  }
}

FrameWriter &FrameWriter::put(std::uint64_t value, unsigned bytes, bool big_endian) {
  while (bytes_.size() % bytes)
    bytes_.push_back({});
  for (unsigned i = 0; i < bytes; ++i) {
    const unsigned place = big_endian ? bytes - 1 - i : i;
    bytes_.push_back(static_cast<std::byte>(value >> (8 * place)));
  }
  return *this;
}

FrameWriter &FrameWriter::end(unsigned alignment) {
  while (bytes_.size() % alignment)
    bytes_.push_back({});
  return *this;
}

BedDevice labelled_adc() {
  BedDevice device;
  const char *labels[] = {"vsin", "vcos", "vtemp"};
  for (int i = 0; i < 3; ++i)
    device.channels.push_back({"voltage" + std::to_string(i),
                               "le:u16/16>>0",
                               {{"label", labels[i]}, {"scale", "0.1"}, {"raw", "0"}}});
  device.channels.push_back({"timestamp", "le:s64/64>>0", {}});
  device.attributes["sampling_frequency"] = "1000";
  return device;
}

std::vector<std::byte> labelled_frames(std::size_t count, std::uint16_t first, std::int64_t time_ns,
                                       std::int64_t period_ns) {
  FrameWriter frames;
  for (std::size_t i = 0; i < count; ++i) {
    const auto sin = static_cast<std::uint16_t>(first + i);
    frames.put(sin, 2).put(static_cast<std::uint16_t>(2 * sin), 2).put(7, 2);
    frames.put(static_cast<std::uint64_t>(time_ns + static_cast<std::int64_t>(i) * period_ns), 8);
  }
  const auto bytes = frames.bytes();
  return {bytes.begin(), bytes.end()};
}

} // namespace ada::test
