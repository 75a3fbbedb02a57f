/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * Calibrates from one recording: calibrate_recording CAPTURE.csv SENSOR.toml */
#include <ada4571.h>
#include <stdio.h>

int main(int argc, char **argv) {
  ada4571_recording *recording = NULL;
  ada4571_model *model = NULL;
  ada4571_baseline baseline;
  ada4571_status status;
  if (argc != 3) {
    fprintf(stderr, "usage: calibrate_recording CAPTURE.csv SENSOR.toml\n");
    return 2;
  }
  ada4571_baseline_init(&baseline);
  status = ada4571_recording_open(argv[1], &recording);
  if (status == ADA4571_OK)
    status = ada4571_calibrate_single(recording, ADA4571_CALIBRATE_FIT, &model);
  if (status == ADA4571_OK)
    status = ada4571_model_get_baseline(model, &baseline);
  if (status == ADA4571_OK)
    status = ada4571_model_save(model, argv[2]);
  if (status == ADA4571_OK)
    printf("offsets %.3f mV and %.3f mV, amplitude %.3f V\n", 1e3 * baseline.offset_sin_v,
           1e3 * baseline.offset_cos_v, baseline.amplitude_v);
  else
    fprintf(stderr, "%s\n", ada4571_last_error());
  ada4571_model_free(model);
  ada4571_recording_free(recording);
  return status == ADA4571_OK ? 0 : 1;
}
