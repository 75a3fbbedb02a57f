/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * The newest angle, as fresh as the machine allows, for a control loop: short buffers, memory that
 * stays where it is, a scheduling class that only waits for its like. Prints the oldest angle that
 * it ever worked with.
 *
 *   closed_loop NAME [SECONDS]      NAME is a stored configuration (iio-angle list --save) */
#define _GNU_SOURCE
#include <ada4571.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

enum { FRAMES = 256, PRIORITY = 50 };

/* Before ada4571_source_start: the thread that reads a network device inherits the class. */
static void become_real_time(void) {
  const struct sched_param priority = {.sched_priority = PRIORITY};
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    perror("memory is not locked (ulimit -l)");
  if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0)
    perror("not under SCHED_FIFO (ulimit -r)");
}

static double now_s(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Age of a frame: both clocks run alike, so that only their difference at the first frame counts. */
static double age_s(const ada4571_source *source, int clock, double time_s) {
  ada4571_source_statistics s;
  struct timespec now;
  ada4571_source_statistics_init(&s);
  if (ada4571_source_get_statistics(source, &s) != ADA4571_OK)
    return 0;
  clock_gettime(clock, &now);
  return 1e-9 * (double)(now.tv_sec * INT64_C(1000000000) + now.tv_nsec - s.first_timestamp_ns) -
         time_s;
}

/* The place for what you do with the angle. */
static void control(double angle_deg) { (void)angle_deg; }

int main(int argc, char **argv) {
  const double seconds = argc > 2 ? atof(argv[2]) : 10;
  ada4571_source *source = NULL;
  ada4571_model *model = NULL;
  ada4571_converter *converter = NULL;
  ada4571_source_info info;
  static ada4571_frame frames[FRAMES];
  static ada4571_angle angles[FRAMES];
  ada4571_read_outcome outcome = ADA4571_READ_FRAMES;
  double oldest_s = 0, start_s = 0;
  size_t n = 0, blocks = 0;
  ada4571_source_info_init(&info);
  ada4571_status status = ada4571_open(argc > 1 ? argv[1] : "sensor", &source);
  if (!status) status = ada4571_source_read_calibration(source, &model);
  if (!status) status = ada4571_converter_new(model, &converter);
  if (!status) status = ada4571_source_set_buffer(source, 1);
  if (!status) status = ada4571_source_get_info(source, &info);
  become_real_time();
  if (!status) status = ada4571_source_start(source);
  for (start_s = now_s(CLOCK_MONOTONIC); !status && now_s(CLOCK_MONOTONIC) - start_s < seconds;) {
    status = ada4571_source_read(source, frames, FRAMES, 1000, &n, &outcome);
    if (!status) status = ada4571_converter_frames(converter, frames, n, angles);
    if (status || n == 0) continue;
    control(angles[n - 1].angle_deg);
    if (++blocks > 3 && info.timestamp_clock >= 0) {
      const double age = age_s(source, info.timestamp_clock, angles[n - 1].time_s);
      oldest_s = age > oldest_s ? age : oldest_s;
    }
  }
  if (status) fprintf(stderr, "%s\n", ada4571_last_error());
  else printf("%zu wake-ups, oldest angle %.3f ms\n", blocks, 1e3 * oldest_s);
  ada4571_converter_free(converter);
  ada4571_model_free(model);
  ada4571_source_free(source);
  return status ? 1 : 0;
}
