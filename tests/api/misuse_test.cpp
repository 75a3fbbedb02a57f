// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Every function of the header called with NULL in place of each pointer that it needs, and with
// arguments out of range: a status, a sentence, results untouched, and never a crash. A table of
// the functions is held against the header, so that a new function cannot be left out.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "handles.h"

namespace {

using api::Handles;
using api::initialised;

void refused(ada4571_status status, const char *call) {
  EXPECT_EQ(status, ADA4571_ERROR_INVALID_ARGUMENT) << call;
  EXPECT_STRNE(ada4571_last_error(), "") << call;
}
#define REFUSED(call) refused(call, #call)

/// A result that a refused call must leave as it was.
template <class Handle> class Untouched {
public:
  ~Untouched() { EXPECT_EQ(value_, mark()) << "a refused call wrote its result"; }
  Handle **operator&() { return &value_; }

private:
  static Handle *mark() { return reinterpret_cast<Handle *>(0x4571); }
  Handle *value_ = mark();
};

using Case = std::function<void(const Handles &)>;

template <class Struct> Case init_takes_null(void (*init)(Struct *)) {
  return [init](const Handles &) {
    init(nullptr);
    EXPECT_EQ(initialised(init).struct_size, sizeof(Struct));
  };
}

template <class Handle> Case free_takes_null(void (*free)(Handle *)) {
  return [free](const Handles &) { free(nullptr); };
}

const std::map<std::string, Case> &status_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_status_name",
       [](const Handles &) {
         EXPECT_STREQ(ada4571_status_name(ADA4571_OK), "ADA4571_OK");
         EXPECT_NE(ada4571_status_name(static_cast<ada4571_status>(127)), nullptr);
       }},
      {"ada4571_last_error", [](const Handles &) { EXPECT_NE(ada4571_last_error(), nullptr); }},
      {"ada4571_version", [](const Handles &) { EXPECT_STREQ(ada4571_version(), "1.0.0"); }},
      {"ada4571_set_jobs",
       [](const Handles &) {
         ada4571_set_jobs(1u << 31); // as many threads as the system gives, and no failure
         ada4571_set_jobs(0);
       }},
  };
  return cases;
}

const std::map<std::string, Case> &source_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_source_options_init", init_takes_null(ada4571_source_options_init)},
      {"ada4571_source_info_init", init_takes_null(ada4571_source_info_init)},
      {"ada4571_source_statistics_init", init_takes_null(ada4571_source_statistics_init)},
      {"ada4571_open",
       [](const Handles &) {
         Untouched<ada4571_source> source;
         REFUSED(ada4571_open(nullptr, &source));
         REFUSED(ada4571_open("name", nullptr));
         EXPECT_EQ(ada4571_open("/nowhere/at/all.toml", &source), ADA4571_ERROR_NOT_FOUND);
       }},
      {"ada4571_source_open",
       [](const Handles &) {
         Untouched<ada4571_source> source;
         auto options = initialised(ada4571_source_options_init);
         REFUSED(ada4571_source_open(nullptr, &source));
         REFUSED(ada4571_source_open(&options, nullptr));
         options.struct_size = 1;
         REFUSED(ada4571_source_open(&options, &source));
         options = initialised(ada4571_source_options_init);
         options.periods_per_turn = 0;
         REFUSED(ada4571_source_open(&options, &source));
         options = initialised(ada4571_source_options_init);
         options.supply_v = std::nan("");
         REFUSED(ada4571_source_open(&options, &source));
       }},
      {"ada4571_source_open_recording",
       [](const Handles &h) {
         Untouched<ada4571_source> source;
         REFUSED(ada4571_source_open_recording(nullptr, &source));
         REFUSED(ada4571_source_open_recording(h.recording, nullptr));
       }},
      {"ada4571_source_open_replay",
       [](const Handles &h) {
         Untouched<ada4571_source> source;
         REFUSED(ada4571_source_open_replay(nullptr, 1.0, &source));
         REFUSED(ada4571_source_open_replay(h.recording, 1.0, nullptr));
         for (const double speed : {0.0, -1.0, 1e7, std::nan("")})
           REFUSED(ada4571_source_open_replay(h.recording, speed, &source));
       }},
      {"ada4571_source_get_fd",
       [](const Handles &h) {
         int fd = -1;
         REFUSED(ada4571_source_get_fd(nullptr, &fd));
         REFUSED(ada4571_source_get_fd(h.source, nullptr));
         EXPECT_EQ(fd, -1);
       }},
      {"ada4571_source_open_simulation",
       [](const Handles &h) {
         Untouched<ada4571_source> source;
         REFUSED(ada4571_source_open_simulation(nullptr, 0, &source));
         REFUSED(ada4571_source_open_simulation(h.simulation, 0, nullptr));
       }},
      {"ada4571_source_get_info",
       [](const Handles &h) {
         auto info = initialised(ada4571_source_info_init);
         REFUSED(ada4571_source_get_info(nullptr, &info));
         REFUSED(ada4571_source_get_info(h.source, nullptr));
         info.struct_size = 0;
         REFUSED(ada4571_source_get_info(h.source, &info));
       }},
      {"ada4571_source_set_buffer",
       [](const Handles &h) {
         REFUSED(ada4571_source_set_buffer(nullptr, 1));
         EXPECT_EQ(ada4571_source_set_buffer(h.source, 1), ADA4571_ERROR_UNSUPPORTED);
       }},
      {"ada4571_source_start", [](const Handles &) { REFUSED(ada4571_source_start(nullptr)); }},
      {"ada4571_source_read",
       [](const Handles &h) {
         ada4571_frame frame;
         std::size_t count = 7;
         ada4571_read_outcome outcome = ADA4571_READ_END;
         REFUSED(ada4571_source_read(nullptr, &frame, 1, 0, &count, &outcome));
         REFUSED(ada4571_source_read(h.source, nullptr, 1, 0, &count, &outcome));
         REFUSED(ada4571_source_read(h.source, &frame, 1, 0, nullptr, &outcome));
         REFUSED(ada4571_source_read(h.source, &frame, 1, 0, &count, nullptr));
         EXPECT_EQ(count, 7u);
         // The right call at the wrong moment.
         EXPECT_EQ(ada4571_source_read(h.source, &frame, 1, 0, &count, &outcome),
                   ADA4571_ERROR_STATE);
       }},
      {"ada4571_block_init", init_takes_null(ada4571_block_init)},
      {"ada4571_source_read_block",
       [](const Handles &h) {
         auto block = initialised(ada4571_block_init);
         ada4571_read_outcome outcome = ADA4571_READ_END;
         REFUSED(ada4571_source_read_block(nullptr, 1, 0, &block, &outcome));
         REFUSED(ada4571_source_read_block(h.source, 1, 0, nullptr, &outcome));
         REFUSED(ada4571_source_read_block(h.source, 1, 0, &block, nullptr));
         REFUSED(ada4571_source_read_block(h.source, 0, 0, &block, &outcome));
         EXPECT_EQ(ada4571_source_read_block(h.source, 1, 0, &block, &outcome),
                   ADA4571_ERROR_UNSUPPORTED);
         block.struct_size = 0;
         REFUSED(ada4571_source_read_block(h.source, 1, 0, &block, &outcome));
       }},
      {"ada4571_source_block_time",
       [](const Handles &h) {
         double time_s = 7.0;
         REFUSED(ada4571_source_block_time(nullptr, 0, &time_s));
         REFUSED(ada4571_source_block_time(h.source, 0, &time_s));
         REFUSED(ada4571_source_block_time(h.source, 0, nullptr));
         EXPECT_EQ(time_s, 7.0);
       }},
      {"ada4571_source_cancel",
       [](const Handles &h) {
         REFUSED(ada4571_source_cancel(nullptr));
         EXPECT_EQ(ada4571_source_cancel(h.source), ADA4571_OK);
       }},
      {"ada4571_source_stop",
       [](const Handles &h) {
         REFUSED(ada4571_source_stop(nullptr));
         EXPECT_EQ(ada4571_source_stop(h.source), ADA4571_OK);
       }},
      {"ada4571_source_get_statistics",
       [](const Handles &h) {
         auto statistics = initialised(ada4571_source_statistics_init);
         REFUSED(ada4571_source_get_statistics(nullptr, &statistics));
         REFUSED(ada4571_source_get_statistics(h.source, nullptr));
         statistics.struct_size = 0;
         REFUSED(ada4571_source_get_statistics(h.source, &statistics));
       }},
      {"ada4571_source_read_calibration",
       [](const Handles &h) {
         Untouched<ada4571_model> model;
         REFUSED(ada4571_source_read_calibration(nullptr, &model));
         REFUSED(ada4571_source_read_calibration(h.source, nullptr));
         EXPECT_NE(ada4571_source_read_calibration(h.source, &model), ADA4571_OK);
       }},
      {"ada4571_model_for_source",
       [](const Handles &h) {
         Untouched<ada4571_model> model;
         REFUSED(ada4571_model_for_source(nullptr, h.source, &model));
         REFUSED(ada4571_model_for_source(h.model, nullptr, &model));
         REFUSED(ada4571_model_for_source(h.model, h.source, nullptr));
       }},
      {"ada4571_source_write_calibration",
       [](const Handles &h) {
         REFUSED(ada4571_source_write_calibration(nullptr, h.model));
         REFUSED(ada4571_source_write_calibration(h.source, nullptr));
         EXPECT_EQ(ada4571_source_write_calibration(h.source, h.model), ADA4571_ERROR_UNSUPPORTED);
       }},
      {"ada4571_source_save_config",
       [](const Handles &h) {
         REFUSED(ada4571_source_save_config(nullptr, "/nowhere/x", nullptr));
         REFUSED(ada4571_source_save_config(h.source, nullptr, nullptr));
       }},
      {"ada4571_source_free", free_takes_null(ada4571_source_free)},
      {"ada4571_device_list_new",
       [](const Handles &) { REFUSED(ada4571_device_list_new("local:", nullptr)); }},
      {"ada4571_device_list_count",
       [](const Handles &) { EXPECT_EQ(ada4571_device_list_count(nullptr), 0u); }},
      {"ada4571_device_list_get",
       [](const Handles &) {
         ada4571_device device{};
         device.struct_size = sizeof device;
         REFUSED(ada4571_device_list_get(nullptr, 0, &device));
       }},
      {"ada4571_device_list_free", free_takes_null(ada4571_device_list_free)},
      {"ada4571_stored_init", init_takes_null(ada4571_stored_init)},
      {"ada4571_stored_list_new",
       [](const Handles &) {
         Untouched<ada4571_stored_list> list;
         REFUSED(ada4571_stored_list_new(nullptr, nullptr));
         REFUSED(ada4571_stored_list_new("-no name-", &list));
       }},
      {"ada4571_stored_list_count",
       [](const Handles &) { EXPECT_EQ(ada4571_stored_list_count(nullptr), 0u); }},
      {"ada4571_stored_list_get",
       [](const Handles &) {
         auto stored = initialised(ada4571_stored_init);
         REFUSED(ada4571_stored_list_get(nullptr, 0, &stored));
       }},
      {"ada4571_stored_list_free", free_takes_null(ada4571_stored_list_free)},
  };
  return cases;
}

const std::map<std::string, Case> &recording_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_recording_info_init", init_takes_null(ada4571_recording_info_init)},
      {"ada4571_recording_open",
       [](const Handles &) {
         Untouched<ada4571_recording> recording;
         REFUSED(ada4571_recording_open(nullptr, &recording));
         REFUSED(ada4571_recording_open("x.csv", nullptr));
         EXPECT_EQ(ada4571_recording_open("/nowhere/x.csv", &recording), ADA4571_ERROR_NOT_FOUND);
       }},
      {"ada4571_recording_get_info",
       [](const Handles &h) {
         auto info = initialised(ada4571_recording_info_init);
         REFUSED(ada4571_recording_get_info(nullptr, &info));
         REFUSED(ada4571_recording_get_info(h.recording, nullptr));
         info.struct_size = 3;
         REFUSED(ada4571_recording_get_info(h.recording, &info));
       }},
      {"ada4571_recording_metadata",
       [](const Handles &h) {
         EXPECT_EQ(ada4571_recording_metadata(nullptr, "serial"), nullptr);
         EXPECT_EQ(ada4571_recording_metadata(h.recording, nullptr), nullptr);
         EXPECT_EQ(ada4571_recording_metadata(h.recording, "no such key"), nullptr);
       }},
      {"ada4571_recording_read",
       [](const Handles &h) {
         ada4571_frame frame;
         std::size_t count = 7;
         REFUSED(ada4571_recording_read(nullptr, 0, &frame, 1, &count));
         REFUSED(ada4571_recording_read(h.recording, 0, nullptr, 1, &count));
         REFUSED(ada4571_recording_read(h.recording, 0, &frame, 1, nullptr));
         EXPECT_EQ(count, 7u);
         EXPECT_EQ(ada4571_recording_read(h.recording, SIZE_MAX, &frame, 1, &count), ADA4571_OK);
         EXPECT_EQ(count, 0u);
       }},
      {"ada4571_recording_save",
       [](const Handles &h) {
         REFUSED(ada4571_recording_save(nullptr, "x.csv"));
         REFUSED(ada4571_recording_save(h.recording, nullptr));
         EXPECT_NE(ada4571_recording_save(h.recording, "/nowhere/x.csv"), ADA4571_OK);
       }},
      {"ada4571_recording_free", free_takes_null(ada4571_recording_free)},
      {"ada4571_writer_open",
       [](const Handles &) {
         Untouched<ada4571_writer> writer;
         auto info = initialised(ada4571_recording_info_init);
         REFUSED(ada4571_writer_open(nullptr, &info, &writer));
         REFUSED(ada4571_writer_open("x.csv", nullptr, &writer));
         REFUSED(ada4571_writer_open("x.csv", &info, nullptr));
         info.struct_size = 0;
         REFUSED(ada4571_writer_open("x.csv", &info, &writer));
       }},
      {"ada4571_writer_open_growing",
       [](const Handles &) {
         Untouched<ada4571_writer> writer;
         auto info = initialised(ada4571_recording_info_init);
         REFUSED(ada4571_writer_open_growing(nullptr, &info, 0, &writer));
         REFUSED(ada4571_writer_open_growing("x.sigmf-meta", nullptr, 0, &writer));
         REFUSED(ada4571_writer_open_growing("x.sigmf-meta", &info, 0, nullptr));
         REFUSED(ada4571_writer_open_growing("x.csv", &info, 0, &writer));
         info.struct_size = 0;
         REFUSED(ada4571_writer_open_growing("x.sigmf-meta", &info, 0, &writer));
       }},
      {"ada4571_writer_open_blocks",
       [](const Handles &h) {
         Untouched<ada4571_writer> writer;
         auto info = initialised(ada4571_recording_info_init);
         REFUSED(ada4571_writer_open_blocks(nullptr, &info, h.source, 0, &writer));
         REFUSED(ada4571_writer_open_blocks("x.sigmf-meta", nullptr, h.source, 0, &writer));
         REFUSED(ada4571_writer_open_blocks("x.sigmf-meta", &info, nullptr, 0, &writer));
         REFUSED(ada4571_writer_open_blocks("x.sigmf-meta", &info, h.source, 0, nullptr));
         // A recording or simulation has none.
         EXPECT_EQ(ada4571_writer_open_blocks("x.sigmf-meta", &info, h.source, 0, &writer),
                   ADA4571_ERROR_UNSUPPORTED);
         info.struct_size = 0;
         REFUSED(ada4571_writer_open_blocks("x.sigmf-meta", &info, h.source, 0, &writer));
       }},
      {"ada4571_writer_write_block",
       [](const Handles &h) { REFUSED(ada4571_writer_write_block(nullptr, h.source, 0, 0.0)); }},
      {"ada4571_writer_metadata",
       [](const Handles &) { REFUSED(ada4571_writer_metadata(nullptr, "key", "value")); }},
      {"ada4571_writer_write",
       [](const Handles &) {
         const ada4571_frame frame{};
         REFUSED(ada4571_writer_write(nullptr, &frame, 1));
       }},
      {"ada4571_writer_finish", [](const Handles &) { REFUSED(ada4571_writer_finish(nullptr)); }},
      {"ada4571_writer_free", free_takes_null(ada4571_writer_free)},
      {"ada4571_import_options_init", init_takes_null(ada4571_import_options_init)},
      {"ada4571_import_open",
       [](const Handles &) {
         Untouched<ada4571_import> import;
         auto options = initialised(ada4571_import_options_init);
         REFUSED(ada4571_import_open(nullptr, &options, &import));
         REFUSED(ada4571_import_open("/dev/null", nullptr, &import));
         REFUSED(ada4571_import_open("/dev/null", &options, nullptr));
         EXPECT_EQ(ada4571_import_open("/nowhere/x.csv", &options, &import),
                   ADA4571_ERROR_NOT_FOUND);
         EXPECT_EQ(ada4571_import_open("/dev/null", &options, &import), ADA4571_ERROR_FORMAT);
         options.separator = ", ";
         REFUSED(ada4571_import_open("/dev/null", &options, &import));
         options.struct_size = 0;
         REFUSED(ada4571_import_open("/dev/null", &options, &import));
       }},
      {"ada4571_import_text",
       [](const Handles &) { EXPECT_STREQ(ada4571_import_text(nullptr), ""); }},
      {"ada4571_import_get_info",
       [](const Handles &) {
         auto info = initialised(ada4571_recording_info_init);
         REFUSED(ada4571_import_get_info(nullptr, &info));
       }},
      {"ada4571_import_read",
       [](const Handles &) {
         ada4571_frame frame;
         std::size_t count = 7;
         REFUSED(ada4571_import_read(nullptr, &frame, 1, &count));
         EXPECT_EQ(count, 7u);
       }},
      {"ada4571_import_free", free_takes_null(ada4571_import_free)},
      {"ada4571_file_open",
       [](const Handles &) {
         Untouched<ada4571_file> file;
         REFUSED(ada4571_file_open(nullptr, &file));
         REFUSED(ada4571_file_open("x.txt", nullptr));
         EXPECT_EQ(ada4571_file_open("/nowhere/x.txt", &file), ADA4571_ERROR_NOT_FOUND);
       }},
      {"ada4571_file_write", [](const Handles &) { REFUSED(ada4571_file_write(nullptr, "x", 1)); }},
      {"ada4571_file_commit", [](const Handles &) { REFUSED(ada4571_file_commit(nullptr)); }},
      {"ada4571_file_free", free_takes_null(ada4571_file_free)},
  };
  return cases;
}

const std::map<std::string, Case> &model_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_baseline_init", init_takes_null(ada4571_baseline_init)},
      {"ada4571_effect_info_init", init_takes_null(ada4571_effect_info_init)},
      {"ada4571_parameter_init", init_takes_null(ada4571_parameter_init)},
      {"ada4571_remainder_init", init_takes_null(ada4571_remainder_init)},
      {"ada4571_catalogue_count",
       [](const Handles &) { EXPECT_GT(ada4571_catalogue_count(), 0u); }},
      {"ada4571_catalogue_get",
       [](const Handles &) {
         auto info = initialised(ada4571_effect_info_init);
         REFUSED(ada4571_catalogue_get(0, nullptr));
         REFUSED(ada4571_catalogue_get(ada4571_catalogue_count(), &info));
         info.struct_size = 0;
         REFUSED(ada4571_catalogue_get(0, &info));
       }},
      {"ada4571_catalogue_parameter",
       [](const Handles &) {
         auto parameter = initialised(ada4571_parameter_init);
         REFUSED(ada4571_catalogue_parameter(0, 0, nullptr));
         REFUSED(ada4571_catalogue_parameter(0, SIZE_MAX, &parameter));
         REFUSED(ada4571_catalogue_parameter(SIZE_MAX, 0, &parameter));
       }},
      {"ada4571_catalogue_range",
       [](const Handles &) {
         double minimum = 0, maximum = 0;
         REFUSED(ada4571_catalogue_range(0, 0, nullptr, &maximum));
         REFUSED(ada4571_catalogue_range(0, 0, &minimum, nullptr));
         REFUSED(ada4571_catalogue_range(0, SIZE_MAX, &minimum, &maximum));
         REFUSED(ada4571_catalogue_range(SIZE_MAX, 0, &minimum, &maximum));
       }},
      {"ada4571_model_new",
       [](const Handles &) {
         Untouched<ada4571_model> model;
         auto baseline = initialised(ada4571_baseline_init);
         REFUSED(ada4571_model_new(nullptr, &model));
         REFUSED(ada4571_model_new(&baseline, nullptr));
         baseline.amplitude_v = std::nan("");
         REFUSED(ada4571_model_new(&baseline, &model));
         baseline = initialised(ada4571_baseline_init);
         baseline.periods_per_turn = -1;
         REFUSED(ada4571_model_new(&baseline, &model));
       }},
      {"ada4571_model_load",
       [](const Handles &) {
         Untouched<ada4571_model> model;
         REFUSED(ada4571_model_load(nullptr, &model));
         REFUSED(ada4571_model_load("x.toml", nullptr));
         EXPECT_EQ(ada4571_model_load("/nowhere/x.toml", &model), ADA4571_ERROR_NOT_FOUND);
       }},
      {"ada4571_model_save",
       [](const Handles &h) {
         REFUSED(ada4571_model_save(nullptr, "x.toml"));
         REFUSED(ada4571_model_save(h.model, nullptr));
         EXPECT_NE(ada4571_model_save(h.model, "/nowhere/x.toml"), ADA4571_OK);
       }},
      {"ada4571_model_get_baseline",
       [](const Handles &h) {
         auto baseline = initialised(ada4571_baseline_init);
         REFUSED(ada4571_model_get_baseline(nullptr, &baseline));
         REFUSED(ada4571_model_get_baseline(h.model, nullptr));
       }},
      {"ada4571_model_add_effect",
       [](const Handles &h) {
         REFUSED(ada4571_model_add_effect(nullptr, "weak-field"));
         REFUSED(ada4571_model_add_effect(h.model, nullptr));
         REFUSED(ada4571_model_add_effect(h.model, "no-such-effect"));
         REFUSED(ada4571_model_add_effect(h.model, "weak-field:no_such=1"));
         REFUSED(ada4571_model_add_effect(h.model, "weak-field:q=nonsense"));
       }},
      {"ada4571_model_effect_count",
       [](const Handles &) { EXPECT_EQ(ada4571_model_effect_count(nullptr), 0u); }},
      {"ada4571_model_effect",
       [](const Handles &h) {
         auto info = initialised(ada4571_effect_info_init);
         REFUSED(ada4571_model_effect(nullptr, 0, &info));
         REFUSED(ada4571_model_effect(h.model, 0, nullptr));
         REFUSED(ada4571_model_effect(h.model, SIZE_MAX, &info));
       }},
      {"ada4571_model_parameter",
       [](const Handles &h) {
         auto parameter = initialised(ada4571_parameter_init);
         REFUSED(ada4571_model_parameter(nullptr, 0, 0, &parameter));
         REFUSED(ada4571_model_parameter(h.model, 0, 0, nullptr));
         REFUSED(ada4571_model_parameter(h.model, 0, SIZE_MAX, &parameter));
         REFUSED(ada4571_model_parameter(h.model, SIZE_MAX, 0, &parameter));
       }},
      {"ada4571_model_get_remainder",
       [](const Handles &h) {
         auto remainder = initialised(ada4571_remainder_init);
         REFUSED(ada4571_model_get_remainder(nullptr, &remainder));
         REFUSED(ada4571_model_get_remainder(h.model, nullptr));
         remainder.struct_size = 1;
         REFUSED(ada4571_model_get_remainder(h.model, &remainder));
       }},
      {"ada4571_model_free", free_takes_null(ada4571_model_free)},
      {"ada4571_calibrate_single",
       [](const Handles &h) {
         Untouched<ada4571_model> model;
         REFUSED(ada4571_calibrate_single(nullptr, ADA4571_CALIBRATE_FIT, &model));
         REFUSED(ada4571_calibrate_single(h.recording, ADA4571_CALIBRATE_FIT, nullptr));
         REFUSED(ada4571_calibrate_single(h.recording, static_cast<ada4571_calibration_method>(3),
                                          &model));
       }},
      {"ada4571_calibrate_dual",
       [](const Handles &h) {
         Untouched<ada4571_model> model;
         const auto fit = ADA4571_CALIBRATE_FIT;
         REFUSED(ada4571_calibrate_dual(nullptr, h.recording, fit, &model));
         REFUSED(ada4571_calibrate_dual(h.recording, nullptr, fit, &model));
         REFUSED(ada4571_calibrate_dual(h.recording, h.recording, fit, nullptr));
         // One temperature twice.
         EXPECT_EQ(ada4571_calibrate_dual(h.recording, h.recording, fit, &model),
                   ADA4571_ERROR_UNUSABLE_DATA);
       }},
  };
  return cases;
}

const std::map<std::string, Case> &conversion_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_layout_init", init_takes_null(ada4571_layout_init)},
      {"ada4571_converter_new",
       [](const Handles &h) {
         Untouched<ada4571_converter> converter;
         REFUSED(ada4571_converter_new(nullptr, &converter));
         REFUSED(ada4571_converter_new(h.model, nullptr));
       }},
      {"ada4571_converter_frames",
       [](const Handles &h) {
         const ada4571_frame frame{};
         ada4571_angle angle;
         REFUSED(ada4571_converter_frames(nullptr, &frame, 1, &angle));
         REFUSED(ada4571_converter_frames(h.converter, nullptr, 1, &angle));
         REFUSED(ada4571_converter_frames(h.converter, &frame, 1, nullptr));
       }},
      {"ada4571_converter_save",
       [](const Handles &h) {
         const auto form = ADA4571_ANGLES_TEXT;
         const auto none = static_cast<ada4571_progress>(nullptr);
         REFUSED(ada4571_converter_save(nullptr, h.recording, "x", form, none, nullptr));
         REFUSED(ada4571_converter_save(h.converter, nullptr, "x", form, none, nullptr));
         REFUSED(ada4571_converter_save(h.converter, h.recording, nullptr, form, none, nullptr));
         REFUSED(ada4571_converter_save(h.converter, h.recording, "x",
                                        static_cast<ada4571_angle_form>(3), none, nullptr));
         REFUSED(ada4571_converter_save(h.converter, h.recording, "x", ADA4571_ANGLES_SIGMF, none,
                                        nullptr)); // a name that is none of SigMF
       }},
      {"ada4571_converter_recording",
       [](const Handles &h) {
         ada4571_angle angle;
         REFUSED(ada4571_converter_recording(nullptr, h.recording, &angle));
         REFUSED(ada4571_converter_recording(h.converter, nullptr, &angle));
         REFUSED(ada4571_converter_recording(h.converter, h.recording, nullptr));
       }},
      {"ada4571_converter_raw_f32",
       [](const Handles &h) {
         auto layout = initialised(ada4571_layout_init);
         const float sample = 1;
         float angle = 0;
         layout.type = ADA4571_F32;
         REFUSED(ada4571_converter_raw_f32(nullptr, &layout, &sample, &sample, 1, &angle, nullptr));
         REFUSED(
             ada4571_converter_raw_f32(h.converter, nullptr, &sample, &sample, 1, &angle, nullptr));
         REFUSED(
             ada4571_converter_raw_f32(h.converter, &layout, nullptr, &sample, 1, &angle, nullptr));
         REFUSED(
             ada4571_converter_raw_f32(h.converter, &layout, &sample, nullptr, 1, &angle, nullptr));
         REFUSED(ada4571_converter_raw_f32(h.converter, &layout, &sample, &sample, 1, nullptr,
                                           nullptr));
         layout.bits = 65;
         REFUSED(
             ada4571_converter_raw_f32(h.converter, &layout, &sample, &sample, 1, &angle, nullptr));
       }},
      {"ada4571_converter_raw_f64",
       [](const Handles &h) {
         auto layout = initialised(ada4571_layout_init);
         const double sample = 1;
         double angle = 0;
         layout.type = ADA4571_F64;
         REFUSED(ada4571_converter_raw_f64(nullptr, &layout, &sample, &sample, 1, &angle, nullptr));
         REFUSED(
             ada4571_converter_raw_f64(h.converter, nullptr, &sample, &sample, 1, &angle, nullptr));
         REFUSED(
             ada4571_converter_raw_f64(h.converter, &layout, nullptr, &sample, 1, &angle, nullptr));
         REFUSED(ada4571_converter_raw_f64(h.converter, &layout, &sample, &sample, 1, nullptr,
                                           nullptr));
         layout.struct_size = 0;
         REFUSED(
             ada4571_converter_raw_f64(h.converter, &layout, &sample, &sample, 1, &angle, nullptr));
       }},
      {"ada4571_converter_free", free_takes_null(ada4571_converter_free)},
      {"ada4571_atan2_f32",
       [](const Handles &) {
         float x = 1;
         REFUSED(ada4571_atan2_f32(nullptr, &x, 1, &x));
         REFUSED(ada4571_atan2_f32(&x, nullptr, 1, &x));
         REFUSED(ada4571_atan2_f32(&x, &x, 1, nullptr));
         EXPECT_EQ(x, 1);
       }},
      {"ada4571_atan2_f64",
       [](const Handles &) {
         double x = 1;
         REFUSED(ada4571_atan2_f64(nullptr, &x, 1, &x));
         REFUSED(ada4571_atan2_f64(&x, nullptr, 1, &x));
         REFUSED(ada4571_atan2_f64(&x, &x, 1, nullptr));
         EXPECT_EQ(x, 1);
       }},
      {"ada4571_vector_target", [](const Handles &) { EXPECT_STRNE(ada4571_vector_target(), ""); }},
      {"ada4571_tracker_options_init", init_takes_null(ada4571_tracker_options_init)},
      {"ada4571_tracker_new",
       [](const Handles &h) {
         Untouched<ada4571_tracker> tracker;
         auto options = initialised(ada4571_tracker_options_init);
         REFUSED(ada4571_tracker_new(nullptr, &options, &tracker));
         REFUSED(ada4571_tracker_new(h.model, &options, nullptr));
         options.struct_size = 0;
         REFUSED(ada4571_tracker_new(h.model, &options, &tracker));
       }},
      {"ada4571_tracker_frames",
       [](const Handles &h) {
         const ada4571_frame frame{};
         ada4571_angle angle;
         auto *tracker = api::make<ada4571_tracker>(
             ada4571_tracker_new, h.model, static_cast<ada4571_tracker_options *>(nullptr));
         REFUSED(ada4571_tracker_frames(nullptr, &frame, 1, &angle));
         REFUSED(ada4571_tracker_frames(tracker, nullptr, 1, &angle));
         REFUSED(ada4571_tracker_frames(tracker, &frame, 1, nullptr));
         ada4571_tracker_free(tracker);
       }},
      {"ada4571_tracker_save",
       [](const Handles &h) {
         const auto form = ADA4571_ANGLES_TEXT;
         const auto none = static_cast<ada4571_progress>(nullptr);
         REFUSED(ada4571_tracker_save(nullptr, h.recording, "x", form, none, nullptr));
         const ada4571_tracker_options *defaults = nullptr;
         auto *tracker = api::make<ada4571_tracker>(ada4571_tracker_new, h.model, defaults);
         REFUSED(ada4571_tracker_save(tracker, nullptr, "x", form, none, nullptr));
         REFUSED(ada4571_tracker_save(tracker, h.recording, nullptr, form, none, nullptr));
         REFUSED(ada4571_tracker_save(tracker, h.recording, "x", static_cast<ada4571_angle_form>(3),
                                      none, nullptr));
         ada4571_tracker_free(tracker);
       }},
      {"ada4571_tracker_model",
       [](const Handles &) {
         Untouched<ada4571_model> model;
         REFUSED(ada4571_tracker_model(nullptr, &model));
       }},
      {"ada4571_tracker_free", free_takes_null(ada4571_tracker_free)},
  };
  return cases;
}

const std::map<std::string, Case> &pins_and_simulation_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_pins_options_init", init_takes_null(ada4571_pins_options_init)},
      {"ada4571_pins_open",
       [](const Handles &) {
         Untouched<ada4571_pins> pins;
         auto options = initialised(ada4571_pins_options_init);
         REFUSED(ada4571_pins_open(nullptr, &pins));
         REFUSED(ada4571_pins_open(&options, nullptr));
         options.struct_size = 0;
         REFUSED(ada4571_pins_open(&options, &pins));
       }},
      {"ada4571_pins_set",
       [](const Handles &) { REFUSED(ada4571_pins_set(nullptr, ADA4571_PIN_GC, 1)); }},
      {"ada4571_pins_get",
       [](const Handles &) {
         int on = 7;
         REFUSED(ada4571_pins_get(nullptr, ADA4571_PIN_GC, &on));
         EXPECT_EQ(on, 7);
       }},
      {"ada4571_pins_free", free_takes_null(ada4571_pins_free)},
      {"ada4571_simulation_options_init", init_takes_null(ada4571_simulation_options_init)},
      {"ada4571_motion_example",
       [](const Handles &) { EXPECT_EQ(ada4571_motion_example(SIZE_MAX), nullptr); }},
      {"ada4571_temperature_example",
       [](const Handles &) { EXPECT_EQ(ada4571_temperature_example(SIZE_MAX), nullptr); }},
      {"ada4571_simulation_new",
       [](const Handles &h) {
         Untouched<ada4571_simulation> simulation;
         auto options = initialised(ada4571_simulation_options_init);
         REFUSED(ada4571_simulation_new(h.model, &options, 1, nullptr));
         options.sample_rate_hz = -1;
         REFUSED(ada4571_simulation_new(h.model, &options, 1, &simulation));
         options = initialised(ada4571_simulation_options_init);
         options.motion = "no such motion";
         REFUSED(ada4571_simulation_new(h.model, &options, 1, &simulation));
         options = initialised(ada4571_simulation_options_init);
         options.duration_s = std::nan("");
         REFUSED(ada4571_simulation_new(h.model, &options, 1, &simulation));
       }},
      {"ada4571_simulation_model",
       [](const Handles &h) {
         Untouched<ada4571_model> model;
         REFUSED(ada4571_simulation_model(nullptr, &model));
         REFUSED(ada4571_simulation_model(h.simulation, nullptr));
       }},
      {"ada4571_simulation_run",
       [](const Handles &h) {
         Untouched<ada4571_recording> recording;
         REFUSED(ada4571_simulation_run(nullptr, &recording));
         REFUSED(ada4571_simulation_run(h.simulation, nullptr));
       }},
      {"ada4571_simulation_free", free_takes_null(ada4571_simulation_free)},
      {"ada4571_emulator_new",
       [](const Handles &h) {
         Untouched<ada4571_emulator> emulator;
         REFUSED(ada4571_emulator_new(nullptr, 0, &emulator));
         REFUSED(ada4571_emulator_new(h.simulation, 0, nullptr));
         REFUSED(ada4571_emulator_new(h.simulation, 70000, &emulator));
         REFUSED(ada4571_emulator_new(h.simulation, -1, &emulator));
       }},
      {"ada4571_emulator_new_replay",
       [](const Handles &h) {
         Untouched<ada4571_emulator> emulator;
         REFUSED(ada4571_emulator_new_replay(nullptr, 1.0, 0, &emulator));
         REFUSED(ada4571_emulator_new_replay(h.recording, 1.0, 0, nullptr));
         REFUSED(ada4571_emulator_new_replay(h.recording, 0.0, 0, &emulator));
         REFUSED(ada4571_emulator_new_replay(h.recording, 1.0, 70000, &emulator));
       }},
      {"ada4571_emulator_port",
       [](const Handles &) { EXPECT_LE(ada4571_emulator_port(nullptr), 0); }},
      {"ada4571_emulator_run", [](const Handles &) { REFUSED(ada4571_emulator_run(nullptr)); }},
      {"ada4571_emulator_stop", [](const Handles &) { ada4571_emulator_stop(nullptr); }},
      {"ada4571_emulator_free", free_takes_null(ada4571_emulator_free)},
  };
  return cases;
}

const std::map<std::string, Case> &diagnosis_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_diagnosis_options_init", init_takes_null(ada4571_diagnosis_options_init)},
      {"ada4571_diagnose_captures",
       [](const Handles &h) {
         ada4571_diagnosis *diagnosis = nullptr;
         const ada4571_recording *one[] = {nullptr};
         REFUSED(ada4571_diagnose_captures(nullptr, 1, nullptr, &diagnosis));
         REFUSED(ada4571_diagnose_captures(one, 1, nullptr, &diagnosis));
         one[0] = h.recording;
         REFUSED(ada4571_diagnose_captures(one, 0, nullptr, &diagnosis));
         REFUSED(ada4571_diagnose_captures(one, 1, nullptr, nullptr));
         ada4571_diagnosis_options options;
         ada4571_diagnosis_options_init(&options);
         options.more_heldout_count = 1; // and no pointer
         REFUSED(ada4571_diagnose_captures(one, 1, &options, &diagnosis));
       }},
      {"ada4571_diagnose",
       [](const Handles &h) {
         Untouched<ada4571_diagnosis> diagnosis;
         auto options = initialised(ada4571_diagnosis_options_init);
         REFUSED(ada4571_diagnose(nullptr, &options, &diagnosis));
         REFUSED(ada4571_diagnose(h.recording, &options, nullptr));
         options.struct_size = 0;
         REFUSED(ada4571_diagnose(h.recording, &options, &diagnosis));
       }},
      {"ada4571_diagnosis_verdict",
       [](const Handles &) {
         EXPECT_EQ(ada4571_diagnosis_verdict(nullptr), ADA4571_INSUFFICIENT_DATA);
       }},
      {"ada4571_diagnosis_reference_aside",
       [](const Handles &) { EXPECT_EQ(ada4571_diagnosis_reference_aside(nullptr), nullptr); }},
      {"ada4571_diagnosis_json",
       [](const Handles &) { EXPECT_STREQ(ada4571_diagnosis_json(nullptr), ""); }},
      {"ada4571_diagnosis_text",
       [](const Handles &) { EXPECT_STREQ(ada4571_diagnosis_text(nullptr), ""); }},
      {"ada4571_finding_init", init_takes_null(ada4571_finding_init)},
      {"ada4571_diagnosis_finding_count",
       [](const Handles &) { EXPECT_EQ(ada4571_diagnosis_finding_count(nullptr), 0u); }},
      {"ada4571_diagnosis_finding",
       [](const Handles &) {
         auto finding = initialised(ada4571_finding_init);
         REFUSED(ada4571_diagnosis_finding(nullptr, 0, &finding));
       }},
      {"ada4571_diagnosis_parameter",
       [](const Handles &) {
         auto parameter = initialised(ada4571_parameter_init);
         REFUSED(ada4571_diagnosis_parameter(nullptr, 0, 0, &parameter));
       }},
      {"ada4571_diagnosis_alternative",
       [](const Handles &) { EXPECT_EQ(ada4571_diagnosis_alternative(nullptr, 0, 0), nullptr); }},
      {"ada4571_diagnosis_model",
       [](const Handles &) {
         Untouched<ada4571_model> model;
         REFUSED(ada4571_diagnosis_model(nullptr, &model));
       }},
      {"ada4571_diagnosis_report",
       [](const Handles &) { REFUSED(ada4571_diagnosis_report(nullptr, "x.html")); }},
      {"ada4571_diagnosis_free", free_takes_null(ada4571_diagnosis_free)},
      {"ada4571_check",
       [](const Handles &h) {
         Untouched<ada4571_health> health;
         REFUSED(ada4571_check(nullptr, h.model, &health));
         REFUSED(ada4571_check(h.recording, h.model, nullptr));
       }},
      {"ada4571_health_sound",
       [](const Handles &) { EXPECT_EQ(ada4571_health_sound(nullptr), 0); }},
      {"ada4571_health_text",
       [](const Handles &) { EXPECT_STREQ(ada4571_health_text(nullptr), ""); }},
      {"ada4571_health_json",
       [](const Handles &) { EXPECT_STREQ(ada4571_health_json(nullptr), ""); }},
      {"ada4571_health_free", free_takes_null(ada4571_health_free)},
      {"ada4571_figure_write",
       [](const Handles &) {
         REFUSED(ada4571_figure_write(nullptr, 1, "."));
         REFUSED(ada4571_figure_write("mismatch", 1, nullptr));
         REFUSED(ada4571_figure_write("no such figure", 1, "."));
       }},
      {"ada4571_figure_name",
       [](const Handles &) { EXPECT_EQ(ada4571_figure_name(SIZE_MAX), nullptr); }},
  };
  return cases;
}

const std::map<std::string, Case> &study_cases() {
  static const std::map<std::string, Case> cases{
      {"ada4571_study_options_init", init_takes_null(ada4571_study_options_init)},
      {"ada4571_study_open",
       [](const Handles &) {
         Untouched<ada4571_study> study;
         auto options = initialised(ada4571_study_options_init);
         REFUSED(ada4571_study_open(nullptr, &options, &study));
         REFUSED(ada4571_study_open("s.db", &options, nullptr));
         options.struct_size = 0;
         REFUSED(ada4571_study_open("s.db", &options, &study));
       }},
      {"ada4571_study_list",
       [](const Handles &) {
         const char *capture = "a.csv";
         REFUSED(ada4571_study_list(nullptr, &capture, 1));
       }},
      {"ada4571_study_find_waiting",
       [](const Handles &) {
         std::size_t count = 0;
         REFUSED(ada4571_study_find_waiting(nullptr, 0, &count));
       }},
      {"ada4571_study_waiting",
       [](const Handles &) { EXPECT_EQ(ada4571_study_waiting(nullptr, 0), nullptr); }},
      {"ada4571_study_analyse",
       [](const Handles &) {
         Untouched<ada4571_study_row> row;
         auto options = initialised(ada4571_study_options_init);
         REFUSED(ada4571_study_analyse(nullptr, &options, &row));
         REFUSED(ada4571_study_analyse("a.csv", &options, nullptr));
         options.struct_size = 0;
         REFUSED(ada4571_study_analyse("a.csv", &options, &row));
       }},
      {"ada4571_study_row_failed",
       [](const Handles &) {
         Untouched<ada4571_study_row> row;
         REFUSED(ada4571_study_row_failed(nullptr, "why", &row));
         REFUSED(ada4571_study_row_failed("a.csv", nullptr, &row));
         REFUSED(ada4571_study_row_failed("a.csv", "why", nullptr));
       }},
      {"ada4571_study_row_text",
       [](const Handles &) { EXPECT_STREQ(ada4571_study_row_text(nullptr), ""); }},
      {"ada4571_study_row_reason",
       [](const Handles &) { EXPECT_STREQ(ada4571_study_row_reason(nullptr), ""); }},
      {"ada4571_study_row_free", free_takes_null(ada4571_study_row_free)},
      {"ada4571_study_put", [](const Handles &) { REFUSED(ada4571_study_put(nullptr, "{}")); }},
      {"ada4571_study_merge",
       [](const Handles &) {
         const char *part = "part.db";
         REFUSED(ada4571_study_merge(nullptr, 1, "whole.db"));
         REFUSED(ada4571_study_merge(&part, 1, nullptr));
       }},
      {"ada4571_study_missing",
       [](const Handles &) { EXPECT_STREQ(ada4571_study_missing(nullptr), ""); }},
      {"ada4571_study_json",
       [](const Handles &) {
         const char *json = nullptr;
         REFUSED(ada4571_study_json(nullptr, &json));
       }},
      {"ada4571_study_text",
       [](const Handles &) {
         const char *text = nullptr;
         REFUSED(ada4571_study_text(nullptr, &text));
       }},
      {"ada4571_study_report",
       [](const Handles &) { REFUSED(ada4571_study_report(nullptr, "page.html")); }},
      {"ada4571_study_free", free_takes_null(ada4571_study_free)},
  };
  return cases;
}

std::map<std::string, Case> all_cases() {
  std::map<std::string, Case> all;
  for (const auto *section :
       {&status_cases(), &source_cases(), &recording_cases(), &model_cases(), &conversion_cases(),
        &pins_and_simulation_cases(), &diagnosis_cases(), &study_cases()})
    all.insert(section->begin(), section->end());
  return all;
}

std::set<std::string> functions_of_header() {
  std::ifstream file(ADA4571_HEADER);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const std::regex declaration(R"(ADA4571_API\b[^;(]*?\b(ada4571_\w+)\s*\()");
  std::set<std::string> names;
  for (std::sregex_iterator it(text.begin(), text.end(), declaration), end; it != end; ++it)
    names.insert((*it)[1]);
  return names;
}

TEST(Misuse, EveryFunctionOfTheHeaderIsTried) {
  std::set<std::string> tried;
  for (const auto &[name, run] : all_cases())
    tried.insert(name);
  EXPECT_EQ(tried, functions_of_header());
}

class MisuseOf : public testing::TestWithParam<std::string> {};

TEST_P(MisuseOf, IsAStatusAndNoCrash) {
  const Handles handles;
  all_cases().at(GetParam())(handles);
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto &[name, run] : all_cases())
    out.push_back(name);
  return out;
}

INSTANTIATE_TEST_SUITE_P(EveryFunction, MisuseOf, testing::ValuesIn(names()),
                         [](const auto &test) { return test.param; });

} // namespace
