// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <utility>

#include "acquisition/iio_source.h"
#include "base/error.h"

namespace ada {

std::vector<IioListEntry> list_iio_devices(const std::string &uri) {
  std::unique_ptr<IioContext> context;
  try {
    context = open_iio_context(uri);
  } catch (const Error &e) {
    if (uri.starts_with("local:") && e.status() == ADA4571_ERROR_NOT_FOUND)
      return {};
    throw;
  }
  std::vector<IioListEntry> out;
  for (IioDevice &device : context->devices()) {
    if (!has_usable_pair(device))
      continue;
    IioListEntry entry{std::move(device), {}, {}, {}, {}, {}, false};
    entry.channels = list_channels(entry.device);
    entry.labelled = labels_name_pair(entry.device);
    for (const IioChannel &c : entry.device.channels) {
      if (!c.is_voltage || c.is_output || c.index < 0)
        continue;
      for (const auto &[label, id] :
           {std::pair("vsin", &entry.sin), std::pair("vcos", &entry.cos),
            std::pair("vtemp", &entry.temp), std::pair("vdd", &entry.vdd)})
        if (c.label == label && id->empty())
          *id = c.id;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

} // namespace ada
