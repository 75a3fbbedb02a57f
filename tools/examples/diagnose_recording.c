/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * Says what the plain simulation gets wrong about a recording: diagnose_recording CAPTURE.csv
 * Takes the findings as values; ada4571_diagnosis_text() has them as text, _json() as JSON. */
#include <ada4571.h>
#include <math.h>
#include <stdio.h>

static ada4571_status print_finding(const ada4571_diagnosis *diagnosis, size_t index) {
  ada4571_finding finding;
  ada4571_parameter parameter;
  ada4571_status status;
  ada4571_finding_init(&finding);
  ada4571_parameter_init(&parameter);
  status = ada4571_diagnosis_finding(diagnosis, index, &finding);
  if (status == ADA4571_OK)
    printf("%s: %.3g -> %.3g mV rms%s\n", finding.cause, 1e3 * finding.residual_rms_before_v,
           1e3 * finding.residual_rms_after_v, finding.correctable ? "" : ", not correctable");
  for (size_t k = 0; status == ADA4571_OK && k < finding.parameters; k++) {
    status = ada4571_diagnosis_parameter(diagnosis, index, k, &parameter);
    if (status == ADA4571_OK && !isnan(parameter.value))
      printf("  %s = %g +- %.2g %s\n", parameter.name, parameter.value, parameter.std_error,
             parameter.unit);
  }
  for (size_t k = 0; status == ADA4571_OK && k < finding.alternatives; k++)
    printf("  or %s\n", ada4571_diagnosis_alternative(diagnosis, index, k));
  return status;
}

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
  if (status == ADA4571_OK && ada4571_diagnosis_finding_count(diagnosis) == 0)
    fputs(ada4571_diagnosis_text(diagnosis), stdout);
  for (size_t i = 0; status == ADA4571_OK && i < ada4571_diagnosis_finding_count(diagnosis); i++)
    status = print_finding(diagnosis, i);
  if (status != ADA4571_OK)
    fprintf(stderr, "%s\n", ada4571_last_error());
  ada4571_diagnosis_free(diagnosis);
  ada4571_recording_free(recording);
  return status == ADA4571_OK ? 0 : 1;
}
