/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * Says what the plain simulation gets wrong about a recording: diagnose_recording CAPTURE.csv */
#include <ada4571.h>
#include <stdio.h>

int main(int argc, char **argv) {
  ada4571_recording *recording = NULL;
  ada4571_diagnosis *diagnosis = NULL;
  ada4571_diagnosis_options options;
  ada4571_status status;
  if (argc != 2) {
    fprintf(stderr, "usage: diagnose_recording CAPTURE.csv\n");
    return 2;
  }
  ada4571_diagnosis_options_init(&options);
  status = ada4571_recording_open(argv[1], &recording);
  if (status == ADA4571_OK)
    status = ada4571_diagnose(recording, &options, &diagnosis);
  if (status == ADA4571_OK)
    fputs(ada4571_diagnosis_text(diagnosis), stdout);
  else
    fprintf(stderr, "%s\n", ada4571_last_error());
  ada4571_diagnosis_free(diagnosis);
  ada4571_recording_free(recording);
  return status == ADA4571_OK ? 0 : 1;
}
