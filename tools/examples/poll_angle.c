/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * poll_angle NAME|CAPTURE.csv: angles in a program that waits by poll() for other things, too; here
 * for a line on standard input, which ends it.
 */
#include <ada4571.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

/* A stored configuration, or a capture played at the speed at which it was recorded. */
static ada4571_status open_source(const char *name, ada4571_source **source) {
  ada4571_recording *recording = NULL;
  ada4571_status status = ADA4571_OK;
  if (!strstr(name, ".csv") && !strstr(name, ".sigmf-")) return ada4571_open(name, source);
  status = ada4571_recording_open(name, &recording);
  if (!status) status = ada4571_source_open_replay(recording, 1.0, source);
  ada4571_recording_free(recording);
  return status;
}

/* Takes what is there, until there is nothing more for now. `ended` is set at the end. */
static ada4571_status take_frames(ada4571_source *source, ada4571_converter *converter, int *ended) {
  ada4571_frame frames[256];
  ada4571_angle angles[256];
  ada4571_read_outcome outcome = ADA4571_READ_FRAMES;
  ada4571_status status = ADA4571_OK;
  size_t n = 0;
  while (!status && outcome == ADA4571_READ_FRAMES) {
    status = ada4571_source_read(source, frames, 256, 0, &n, &outcome);
    if (!status && n > 0) status = ada4571_converter_frames(converter, frames, n, angles);
    if (!status && n > 0) printf("%8.3f s %8.3f deg\n", angles[n - 1].time_s, angles[n - 1].angle_deg);
  }
  *ended = outcome != ADA4571_READ_TIMEOUT;
  return status;
}

int main(int argc, char **argv) {
  ada4571_source *source = NULL;
  ada4571_model *model = NULL;
  ada4571_converter *converter = NULL;
  int ended = 0;
  struct pollfd fds[2] = {{-1, POLLIN, 0}, {0, POLLIN, 0}};
  ada4571_status status = open_source(argc > 1 ? argv[1] : "sensor", &source);
  if (!status && ada4571_source_read_calibration(source, &model)) { /* none: an ideal sensor */
    ada4571_baseline baseline;
    ada4571_baseline_init(&baseline);
    status = ada4571_model_new(&baseline, &model);
  }
  if (!status) status = ada4571_converter_new(model, &converter);
  if (!status) status = ada4571_source_start(source);
  if (!status) status = ada4571_source_get_fd(source, &fds[0].fd);
  while (!status && !ended) {
    if (poll(fds, 2, -1) < 0) break;
    if (fds[1].revents) break;
    if (fds[0].revents) status = take_frames(source, converter, &ended);
  }
  if (status) fprintf(stderr, "%s\n", ada4571_last_error());
  ada4571_converter_free(converter);
  ada4571_model_free(model);
  ada4571_source_free(source);
  return status ? 1 : 0;
}
