// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <memory>

#include <fmt/format.h>

#include "common/print.h"
#include "common/source_options.h"
#include "common/verb.h"

namespace cli {

namespace {

struct Options {
  SourceOptions source;
  std::string save, calibration;
};

/// Stores how the device that the options choose is opened.
int save(const Options &options) {
  const Source source = open_source(options.source);
  check_usage(ada4571_source_save_config(
      source.get(), options.save.c_str(),
      options.calibration.empty() ? nullptr : options.calibration.c_str()));
  note("stored: from now on `-s {}` opens {}\n", options.save, source_info(source).description);
  return kDone;
}

int run(const Options &options) {
  if (!options.save.empty())
    return save(options);
  const char *uri = options.source.uri.empty() ? nullptr : options.source.uri.c_str();
  const auto list = make<DeviceList>(ada4571_device_list_new, uri);
  const std::size_t count = ada4571_device_list_count(list.get());
  for (std::size_t i = 0; i < count; ++i) {
    ada4571_device device{};
    device.struct_size = sizeof device;
    check(ada4571_device_list_get(list.get(), i, &device));
    print("{}  {}{}{}\n  channels: {}\n", device.id, device.name, *device.label ? "  label " : "",
          device.label, device.channels);
    print("  {}: iio-angle read{} -d {}{}\n",
          device.labelled ? "the labels name the pair" : "you name the pair",
          uri != nullptr ? fmt::format(" -u {}", uri) : "", device.id,
          device.labelled ? "" : " --sin CHANNEL --cos CHANNEL");
  }
  if (count == 0)
    throw Failure(kUnusable,
                  "no device with a pair of buffered voltage channels: is the driver loaded, and "
                  "may this user read /dev/iio:device* (group plugdev, see udev/README.md)?");
  return kDone;
}

} // namespace

void add_list(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("list", "devices with a usable pair of channels");
  auto options = std::make_shared<Options>();
  add_source_options(*verb, options->source);
  verb->add_option("--save", options->save,
                   "store how the chosen device is opened as NAME, for -s NAME")
      ->type_name("NAME");
  verb->add_option("--calibration", options->calibration,
                   "with --save: the calibration file that belongs to it")
      ->needs("--save")
      ->type_name("FILE");
  example(*verb, "  iio-angle list\n"
                 "  iio-angle list -u ip:192.168.1.20\n"
                 "  iio-angle list -d ad7380 --sin voltage0 --cos voltage1 --save wheel");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
