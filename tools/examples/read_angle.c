/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * Angles of a stored device with its calibration: read_angle NAME */
#include <ada4571.h>
#include <stdio.h>

int main(int argc, char **argv) {
  ada4571_source *source = NULL;
  ada4571_model *model = NULL;
  ada4571_converter *converter = NULL;
  ada4571_frame frames[64];
  ada4571_angle angles[64];
  ada4571_read_outcome outcome = ADA4571_READ_FRAMES;
  size_t n = 0;
  ada4571_status status = ada4571_open(argc > 1 ? argv[1] : "sensor", &source);
  if (!status) status = ada4571_source_read_calibration(source, &model);
  if (!status) status = ada4571_converter_new(model, &converter);
  if (!status) status = ada4571_source_start(source);
  for (int i = 0; !status && i < 50 && outcome == ADA4571_READ_FRAMES; i++) {
    status = ada4571_source_read(source, frames, 64, 1000, &n, &outcome);
    if (!status) status = ada4571_converter_frames(converter, frames, n, angles);
    if (!status && n > 0) printf("%8.3f s %8.3f deg\n", angles[0].time_s, angles[0].angle_deg);
  }
  if (status) fprintf(stderr, "%s\n", ada4571_last_error());
  ada4571_converter_free(converter);
  ada4571_model_free(model);
  ada4571_source_free(source);
  return status ? 1 : 0;
}
