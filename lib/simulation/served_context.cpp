// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/served_context.h"

#include <algorithm>

#include "base/text.h"

namespace ada {

namespace {

/// A client takes its run back at once. More of them are of clients that will not.
constexpr std::size_t kMostLeftRuns = 64;

/// libiio parses with validation, so the document type must come along.
constexpr const char *kProlog =
    "<?xml version=\"1.0\" encoding=\"utf-8\"?><!DOCTYPE context ["
    "<!ELEMENT context (device | context-attribute)*><!ELEMENT context-attribute EMPTY>"
    "<!ELEMENT device (channel | attribute | debug-attribute | buffer-attribute)*>"
    "<!ELEMENT channel (scan-element?, attribute*)><!ELEMENT attribute EMPTY>"
    "<!ELEMENT scan-element EMPTY><!ELEMENT debug-attribute EMPTY>"
    "<!ELEMENT buffer-attribute EMPTY>"
    "<!ATTLIST context name CDATA #REQUIRED version-major CDATA #REQUIRED version-minor CDATA "
    "#REQUIRED version-git CDATA #REQUIRED description CDATA #IMPLIED>"
    "<!ATTLIST context-attribute name CDATA #REQUIRED value CDATA #REQUIRED>"
    "<!ATTLIST device id CDATA #REQUIRED name CDATA #IMPLIED label CDATA #IMPLIED>"
    "<!ATTLIST channel id CDATA #REQUIRED type (input|output) #REQUIRED name CDATA #IMPLIED>"
    "<!ATTLIST scan-element index CDATA #REQUIRED format CDATA #REQUIRED scale CDATA #IMPLIED>"
    "<!ATTLIST attribute name CDATA #REQUIRED filename CDATA #IMPLIED>"
    "<!ATTLIST debug-attribute name CDATA #REQUIRED>"
    "<!ATTLIST buffer-attribute name CDATA #REQUIRED>]>";

std::string escaped(const std::string &text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
    case '&':
      out += "&amp;";
      break;
    case '<':
      out += "&lt;";
      break;
    case '>':
      out += "&gt;";
      break;
    case '"':
      out += "&quot;";
      break;
    default:
      out += c;
    }
  }
  return out;
}

std::string attribute(const char *name, const std::string &value) {
  return " " + std::string(name) + "=\"" + escaped(value) + "\"";
}

std::string optional_attribute(const char *name, const std::string &value) {
  return value.empty() ? std::string() : attribute(name, value);
}

std::string channel_xml(const ServedChannel &channel) {
  std::string xml = "<channel" + attribute("id", channel.id) + attribute("type", "input") + " >";
  if (channel.index >= 0)
    xml += "<scan-element" + attribute("index", std::to_string(channel.index)) +
           attribute("format", to_string(channel.format)) +
           (channel.scale_mv ? attribute("scale", in_full(*channel.scale_mv)) : "") + " />";
  for (const ServedAttribute &a : channel.attributes)
    xml += "<attribute" + attribute("name", a.name) +
           attribute("filename", "in_" + channel.id + "_" + a.name) + " />";
  return xml + "</channel>";
}

} // namespace

ServedDevice *ServedContext::find_device(std::string_view id) {
  for (ServedDevice &device : devices)
    if (device.id == id)
      return &device;
  return nullptr;
}

void LeftRuns::leave(const ServedDevice &device, std::string mask, Run run) {
  if (left_.size() == kMostLeftRuns)
    left_.erase(left_.begin());
  left_.push_back({&device, std::move(mask), device.rate_hz, std::move(run)});
}

std::optional<Run> LeftRuns::take(const ServedDevice &device, std::string_view mask) {
  const auto found = std::find_if(left_.begin(), left_.end(), [&](const Left &left) {
    return left.device == &device && left.mask == mask && left.rate_hz == device.rate_hz;
  });
  if (found == left_.end())
    return std::nullopt;
  std::optional<Run> run = std::move(found->run);
  left_.erase(found);
  return run;
}

std::string context_xml(const ServedContext &context) {
  std::string xml = kProlog;
  xml += "<context" + attribute("name", "local") + attribute("version-major", "0") +
         attribute("version-minor", "24") + attribute("version-git", "v0.24") +
         attribute("description", context.description) + " >";
  for (const auto &[name, value] : context.attributes)
    xml += "<context-attribute" + attribute("name", name) + attribute("value", value) + " />";
  for (const ServedDevice &device : context.devices) {
    xml += "<device" + attribute("id", device.id) + optional_attribute("name", device.name) +
           optional_attribute("label", device.label) + " >";
    for (const ServedChannel &channel : device.channels)
      xml += channel_xml(channel);
    for (const ServedAttribute &a : device.attributes)
      xml += "<attribute" + attribute("name", a.name) + " />";
    xml += "</device>";
  }
  return xml + "</context>";
}

} // namespace ada
