// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/known_names.h"
#include "common/print.h"
#include "common/source_options.h"
#include "common/spelling.h"
#include "common/verb.h"

namespace cli {

namespace {

using Json = nlohmann::ordered_json;

struct ListOptions {
  SourceOptions source;
  std::string save, calibration;
  bool no_calibration = false, json = false;
};

/// Stores how the device that the options choose is opened. What was stored under the name and is
/// not given anew stays.
int save(const ListOptions &options) {
  const Source source = open_source(options.source);
  const char *calibration = options.no_calibration        ? ""
                            : options.calibration.empty() ? nullptr
                                                          : options.calibration.c_str();
  const ada4571_status status =
      ada4571_source_save_config(source.get(), options.save.c_str(), calibration);
  if (status == ADA4571_ERROR_INVALID_ARGUMENT)
    throw Failure(kWrongUsage, fmt::format("--save: {}", ada4571_last_error()));
  check(status);
  const auto list = make<StoredList>(ada4571_stored_list_new, options.save.c_str());
  auto stored = initialised(ada4571_stored_init);
  check(ada4571_stored_list_get(list.get(), 0, &stored));
  note("stored in {}: from now on `-s {}` opens {}{}{}\n", stored.path, options.save,
       source_info(source).description, *stored.calibration_file ? ", calibrated by " : "",
       stored.calibration_file);
  return kDone;
}

struct Where {
  std::string uri, device; ///< empty: local:, and all of them
};

/// A stored configuration lives at its own address.
Where where_of(const SourceOptions &source) {
  if (source.stored.empty())
    return {source.uri, source.device};
  const StoredList list = open_stored(source.stored, [&source] {
    return make_as_asked<StoredList>(ada4571_stored_list_new, source.stored.c_str());
  });
  auto stored = initialised(ada4571_stored_init);
  check(ada4571_stored_list_get(list.get(), 0, &stored));
  return {stored.uri, stored.device};
}

std::vector<ada4571_device> devices_of(const DeviceList &list, const Where &where) {
  const std::string &wanted = where.device;
  std::vector<ada4571_device> devices;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < ada4571_device_list_count(list.get()); ++i) {
    ada4571_device device{};
    device.struct_size = sizeof device;
    check(ada4571_device_list_get(list.get(), i, &device));
    names.insert(names.end(), {device.id, device.name, device.label});
    if (wanted.empty() || wanted == device.id || wanted == device.name || wanted == device.label)
      devices.push_back(device);
  }
  if (names.empty())
    throw Failure(kUnusable,
                  where.uri.empty() || where.uri == "local:"
                      ? "no device with a pair of buffered voltage channels: is the driver loaded, "
                        "and may this user read /dev/iio:device* (is it in the group plugdev)?"
                      : fmt::format("{} has no device with a pair of buffered voltage channels: "
                                    "`iio_info -u {}` shows what it has",
                                    where.uri, where.uri));
  if (devices.empty())
    throw Failure(kUnusable, fmt::format("no usable device is called '{}'{}", wanted,
                                         did_you_mean(wanted, names)));
  return devices;
}

void print_text(const ada4571_device &device, const std::string &uri) {
  print("{}  {}{}{}\n  channels: {}\n", device.id, device.name, *device.label ? "  label " : "",
        device.label, device.channels);
  print("  {}: iio-angle read{} -d {}{}\n",
        device.labelled ? "the labels name the pair" : "you name the pair",
        uri.empty() ? "" : fmt::format(" -u {}", uri), device.id,
        device.labelled ? "" : " --sin CHANNEL --cos CHANNEL");
}

Json to_json(const ada4571_device &device) {
  const auto channel = [](const char *id) { return *id ? Json(id) : Json(nullptr); };
  return {{"id", device.id},
          {"name", device.name},
          {"label", device.label},
          {"channels", device.channels},
          {"labelled", device.labelled != 0},
          {"sin", channel(device.sin_channel)},
          {"cos", channel(device.cos_channel)},
          {"temp", channel(device.temp_channel)},
          {"vdd", channel(device.vdd_channel)}};
}

int run(const ListOptions &options) {
  if (!options.save.empty())
    return save(options);
  const Where where = where_of(options.source);
  const auto list =
      make<DeviceList>(ada4571_device_list_new, where.uri.empty() ? nullptr : where.uri.c_str());
  Json devices = Json::array();
  for (const ada4571_device &device : devices_of(list, where))
    if (options.json)
      devices.push_back(to_json(device));
    else
      print_text(device, where.uri);
  if (options.json)
    print("{}\n", Json{{"schema", "ada4571-list/1"},
                       {"uri", where.uri.empty() ? "local:" : where.uri},
                       {"devices", devices}}
                      .dump(1));
  return kDone;
}

/// -s takes a path as well, but what is stored under a name goes to where names are looked for.
CLI::Validator no_path() {
  return {[](std::string &name) -> std::string {
            return name.find('/') == name.npos
                       ? ""
                       : fmt::format("'{}' is a path: give a name without a slash", name);
          },
          ""};
}

/// What only says how a device is opened means nothing where none is.
void require_save_for_the_rest(const CLI::App &verb) {
  if (verb.count("--save") > 0)
    return;
  for (const char *name : {"--sin", "--cos", "--temp", "--vdd", "--trigger", "--rate", "--supply",
                           "--periods", "--within"})
    if (verb.count(name) > 0)
      throw CLI::RequiresError(name, "--save");
}

} // namespace

void add_list(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("list", "devices with a usable pair of channels");
  auto options = std::make_shared<ListOptions>();
  add_source_options(*verb, options->source);
  auto *save = verb->add_option("--save", options->save,
                                "store how the chosen device is opened as NAME, for -s NAME");
  save->transform(no_path())->type_name("NAME");
  auto *calibration =
      verb->add_option("--calibration", options->calibration,
                       "calibration file that belongs to it (default: the one that NAME has)")
          ->needs(save)
          ->type_name("FILE");
  verb->add_flag("--no-calibration", options->no_calibration, "forget the calibration")
      ->needs(save)
      ->excludes(calibration);
  verb->add_flag("--json", options->json, "print JSON (ada4571-list/1) instead of text")
      ->excludes(save);
  example(*verb, "  iio-angle list\n"
                 "  iio-angle list -u ip:192.168.1.20\n"
                 "  iio-angle list -d ad7380 --sin voltage0 --cos voltage1 --save wheel");
  verb->callback([options, verb, &action] {
    require_save_for_the_rest(*verb);
    action = [options] { return run(*options); };
  });
}

} // namespace cli
