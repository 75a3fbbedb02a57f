/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * Simulates, calibrates and converts through the installed library. */
#include <ada4571.h>
#include <stdio.h>

int main(void) {
  ada4571_simulation_options options;
  ada4571_simulation *simulation = NULL;
  ada4571_recording *recording = NULL;
  ada4571_model *model = NULL;
  ada4571_converter *converter = NULL;
  ada4571_frame frame;
  ada4571_angle angle;
  size_t count = 0;
  ada4571_simulation_options_init(&options);
  options.duration_s = 1;
  if (ada4571_simulation_new(NULL, &options, 4571, &simulation) != ADA4571_OK ||
      ada4571_simulation_run(simulation, &recording) != ADA4571_OK ||
      ada4571_calibrate_single(recording, ADA4571_CALIBRATE_FIT, &model) != ADA4571_OK ||
      ada4571_converter_new(model, &converter) != ADA4571_OK ||
      ada4571_recording_read(recording, 0, &frame, 1, &count) != ADA4571_OK || count != 1 ||
      ada4571_converter_frames(converter, &frame, 1, &angle) != ADA4571_OK) {
    fprintf(stderr, "%s\n", ada4571_last_error());
    return 1;
  }
  printf("%.3f\n", angle.angle_deg);
  ada4571_converter_free(converter);
  ada4571_model_free(model);
  ada4571_recording_free(recording);
  ada4571_simulation_free(simulation);
  return angle.status == 0 ? 0 : 1;
}
