// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/row.h"

#include <cmath>
#include <limits>
#include <tuple>

#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "base/error.h"

namespace ada::study {

namespace {

using Json = nlohmann::json;

/// JSON knows no NaN.
Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

double number_of(const Json &j) {
  return j.is_null() ? kNaN : j.get<double>();
}

Json quantities_of(const Row &row) {
  Json out = Json::array();
  for (const Quantity &q : row.quantities)
    out.push_back({q.place, q.cause, q.parameter, q.unit, number(q.value), number(q.std_error)});
  return out;
}

Json findings_of(const Row &row) {
  Json out = Json::array();
  for (const FoundCause &f : row.findings)
    out.push_back({f.cause, f.alternatives, number(f.angle_rms_deg), f.correctable});
  return out;
}

Json checks_of(const Row &row) {
  Json out = Json::array();
  for (const CheckLine &c : row.checks)
    out.push_back({c.check, c.state, number(c.measured), number(c.limit), c.unit});
  return out;
}

Row parsed(const Json &j) {
  Row row;
  row.capture = j.at("capture");
  row.state = j.at("failed").get<bool>() ? RowState::failed : RowState::done;
  row.reason = j.at("reason");
  row.bytes = j.at("bytes");
  row.modified_ns = j.at("modified_ns");
  row.identity = j.at("identity");
  row.program = j.at("program");
  row.report = j.at("report");
  row.serial = j.at("serial");
  row.has_reference = j.at("has_reference");
  row.samples = j.at("samples");
  row.duration_s = number_of(j.at("duration_s"));
  row.sound = j.at("sound");
  row.verdict = j.at("verdict");
  row.extended_angle_rms_deg = number_of(j.at("extended_angle_rms_deg"));
  row.factors = j.at("factors").get<decltype(row.factors)>();
  for (const Json &c : j.at("checks"))
    row.checks.push_back({c.at(0), c.at(1), number_of(c.at(2)), number_of(c.at(3)), c.at(4)});
  for (const Json &f : j.at("findings"))
    row.findings.push_back({f.at(0), f.at(1), number_of(f.at(2)), f.at(3)});
  for (const Json &q : j.at("quantities"))
    row.quantities.push_back(
        {q.at(0), q.at(1), q.at(2), q.at(3), number_of(q.at(4)), number_of(q.at(5))});
  row.signature.values = j.at("signature").get<std::vector<double>>();
  row.signature.periods = j.at("periods");
  return row;
}

} // namespace

std::string row_to_text(const Row &row) {
  const Json out = {{"capture", row.capture},
                    {"failed", row.state == RowState::failed},
                    {"reason", row.reason},
                    {"bytes", row.bytes},
                    {"modified_ns", row.modified_ns},
                    {"identity", row.identity},
                    {"program", row.program},
                    {"report", row.report},
                    {"serial", row.serial},
                    {"has_reference", row.has_reference},
                    {"samples", row.samples},
                    {"duration_s", number(row.duration_s)},
                    {"sound", row.sound},
                    {"verdict", row.verdict},
                    {"extended_angle_rms_deg", number(row.extended_angle_rms_deg)},
                    {"factors", row.factors},
                    {"checks", checks_of(row)},
                    {"findings", findings_of(row)},
                    {"quantities", quantities_of(row)},
                    {"periods", row.signature.periods},
                    {"signature", row.signature.values}};
  // File names and headers may hold any bytes.
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Row row_from_text(const std::string &text) {
  try {
    return parsed(Json::parse(text));
  } catch (const Json::exception &e) {
    throw Error(ADA4571_ERROR_FORMAT, std::string("not the row of a capture: ") + e.what());
  }
}

bool better(const Row &a, const Row &b) {
  const auto rank = [](const Row &r) {
    return std::tuple(r.state == RowState::done, r.state == RowState::failed, r.modified_ns,
                      r.bytes, r.program);
  };
  if (rank(a) != rank(b))
    return rank(a) > rank(b);
  return row_to_text(a) > row_to_text(b);
}

FileStamp stamp_of(const std::string &capture) {
  FileStamp out;
  const auto add = [&out](const std::string &path) {
    struct stat s;
    if (::stat(path.c_str(), &s) != 0)
      return;
    out.bytes += s.st_size;
    out.modified_ns = std::max<std::int64_t>(
        out.modified_ns, s.st_mtim.tv_sec * INT64_C(1000000000) + s.st_mtim.tv_nsec);
  };
  add(capture);
  for (const std::string end : {".sigmf-meta", ".sigmf-data"})
    if (capture.size() > end.size() && capture.ends_with(end))
      add(capture.substr(0, capture.size() - end.size()) +
          (end == ".sigmf-meta" ? ".sigmf-data" : ".sigmf-meta"));
  return out;
}

} // namespace ada::study
