/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * What the kernel checks need of the C interface and iio-angle does not show: values to the last
 * bit, times of events, and one handle that lives through a loss. Each verb prints what happened;
 * the checks judge it. */
#include <ada4571.h>

#include <errno.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void die(const char *what) {
  fprintf(stderr, "%s: %s\n", what, ada4571_last_error());
  exit(1);
}

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static ada4571_source *open_source(const char *uri, const char *device) {
  ada4571_source_options options;
  ada4571_source *source = NULL;
  ada4571_source_options_init(&options);
  options.uri = uri;
  options.device = device;
  if (ada4571_source_open(&options, &source) != ADA4571_OK)
    die("open");
  return source;
}

static void start(ada4571_source *source) {
  if (ada4571_source_start(source) != ADA4571_OK)
    die("start");
}

static void print_statistics(ada4571_source *source) {
  ada4571_source_statistics s;
  ada4571_source_statistics_init(&s);
  ada4571_source_get_statistics(source, &s);
  printf("# frames %llu lost %llu gaps %llu\n", (unsigned long long)s.frames,
         (unsigned long long)s.lost, (unsigned long long)s.gaps);
}

/* Reads `wanted` frames and prints them unless quiet; the status that ended it. */
static ada4571_status read_frames(ada4571_source *source, size_t wanted, int quiet) {
  ada4571_frame frames[256];
  while (wanted > 0) {
    size_t count = 0;
    ada4571_read_outcome outcome;
    const size_t capacity = wanted < 256 ? wanted : 256;
    const ada4571_status status =
        ada4571_source_read(source, frames, capacity, 10000, &count, &outcome);
    if (status != ADA4571_OK)
      return status;
    if (outcome != ADA4571_READ_FRAMES) {
      fprintf(stderr, "outcome %d with %zu frames still to come\n", (int)outcome, wanted);
      exit(1);
    }
    for (size_t i = 0; i < count && !quiet; ++i)
      printf("%.9f %.17g %.17g %.17g %.17g\n", frames[i].time_s, frames[i].vsin_v,
             frames[i].vcos_v, frames[i].vtemp_v, frames[i].vdd_v);
    wanted -= count;
  }
  return ADA4571_OK;
}

/* frames URI DEVICE COUNT: one frame a line, then the statistics. */
static int frames(char **argv) {
  ada4571_source *source = open_source(argv[0], argv[1]);
  start(source);
  if (read_frames(source, strtoul(argv[2], NULL, 10), 0) != ADA4571_OK)
    die("read");
  print_statistics(source);
  ada4571_source_free(source);
  return 0;
}

/* timeout URI DEVICE MILLISECONDS COUNT: the outcome of a read of nothing and how long it took,
 * then COUNT frames of the same capture. */
static int timeout(char **argv) {
  ada4571_source *source = open_source(argv[0], argv[1]);
  ada4571_frame frame;
  ada4571_read_outcome outcome;
  size_t count = 0;
  start(source);
  const double begun = now_s();
  if (ada4571_source_read(source, &frame, 1, atoi(argv[2]), &count, &outcome) != ADA4571_OK)
    die("read");
  printf("outcome %d count %zu after %.3f s\n", (int)outcome, count, now_s() - begun);
  fflush(stdout);
  if (read_frames(source, strtoul(argv[3], NULL, 10), 0) != ADA4571_OK)
    die("read");
  ada4571_source_free(source);
  return 0;
}

/* replug URI DEVICE COUNT: COUNT frames, then on until the capture ends in an error; on a line of
 * standard input the same handle is started again and gives COUNT frames more. */
static int replug(char **argv) {
  ada4571_source *source = open_source(argv[0], argv[1]);
  const size_t count = strtoul(argv[2], NULL, 10);
  char line[16];
  start(source);
  if (read_frames(source, count, 1) != ADA4571_OK)
    die("read");
  printf("before %zu\n", count);
  fflush(stdout);
  const double begun = now_s();
  const ada4571_status status = read_frames(source, SIZE_MAX, 1);
  printf("ended %s after %.3f s: %s\n", ada4571_status_name(status), now_s() - begun,
         ada4571_last_error());
  fflush(stdout);
  if (!fgets(line, sizeof line, stdin))
    return 1;
  start(source);
  if (read_frames(source, count, 1) != ADA4571_OK)
    die("read");
  printf("again %zu\n", count);
  ada4571_source_free(source);
  return 0;
}

static double cancel_asked_s;

static void *cancel_later(void *source) {
  const struct timespec pause = {0, 500000000};
  nanosleep(&pause, NULL);
  cancel_asked_s = now_s();
  ada4571_source_cancel(source);
  return NULL;
}

/* cancel URI DEVICE: a read without end, cancelled by another thread, and the delay of its end. */
static int cancel(char **argv) {
  ada4571_source *source = open_source(argv[0], argv[1]);
  ada4571_frame buffer[256];
  ada4571_read_outcome outcome = ADA4571_READ_FRAMES;
  size_t count = 0;
  pthread_t thread;
  start(source);
  if (pthread_create(&thread, NULL, cancel_later, source) != 0)
    return 1;
  while (outcome == ADA4571_READ_FRAMES)
    if (ada4571_source_read(source, buffer, 256, -1, &count, &outcome) != ADA4571_OK)
      die("read");
  const double ended = now_s();
  pthread_join(thread, NULL);
  printf("outcome %d after %.4f s\n", (int)outcome, ended - cancel_asked_s);
  ada4571_source_free(source);
  return 0;
}

static void print_baseline(const ada4571_model *model) {
  ada4571_baseline b;
  ada4571_baseline_init(&b);
  if (ada4571_model_get_baseline(model, &b) != ADA4571_OK)
    die("baseline");
  printf("offset_sin %.6f offset_cos %.6f amplitude %.6f\n", b.offset_sin_v, b.offset_cos_v,
         b.amplitude_v);
}

/* calibration URI DEVICE [FILE]: writes FILE to the driver's calibbias and calibscale, then prints
 * what the driver keeps. */
static int calibration(char **argv) {
  ada4571_source *source = open_source(argv[0], argv[1]);
  ada4571_model *model = NULL;
  if (argv[2]) {
    if (ada4571_model_load(argv[2], &model) != ADA4571_OK)
      die("load");
    if (ada4571_source_write_calibration(source, model) != ADA4571_OK)
      die("write");
    ada4571_model_free(model);
  }
  const ada4571_status status = ada4571_source_read_calibration(source, &model);
  if (status != ADA4571_OK) {
    printf("%s: %s\n", ada4571_status_name(status), ada4571_last_error());
    return 1;
  }
  print_baseline(model);
  ada4571_model_free(model);
  ada4571_source_free(source);
  return 0;
}

static int set_pin(ada4571_pins *pins, const char *name, const char *state) {
  const ada4571_pin pin = strcmp(name, "gc") == 0 ? ADA4571_PIN_GC : ADA4571_PIN_PD;
  int on = -1;
  const double begun = now_s();
  if (ada4571_pins_set(pins, pin, strcmp(state, "on") == 0) != ADA4571_OK)
    die("set");
  const double took = now_s() - begun;
  if (ada4571_pins_get(pins, pin, &on) != ADA4571_OK)
    die("get");
  printf("%s %s after %.6f s\n", name, on ? "on" : "off", took);
  fflush(stdout);
  return 0;
}

/* pins [low]: each line "gc on", "pd off" and so on of standard input sets a pin; the lines are
 * held until its end. */
static int pins(char **argv) {
  ada4571_pins_options options;
  ada4571_pins *handle = NULL;
  char name[8], state[8];
  ada4571_pins_options_init(&options);
  if (argv[0] && strcmp(argv[0], "low") == 0)
    options.gc_active_low = options.pd_active_low = 1;
  if (ada4571_pins_open(&options, &handle) != ADA4571_OK)
    die("pins");
  while (scanf("%7s %7s", name, state) == 2)
    set_pin(handle, name, state);
  ada4571_pins_free(handle);
  return 0;
}

int main(int argc, char **argv) {
  static const struct {
    const char *name;
    int least;
    int (*run)(char **argv);
  } verbs[] = {{"frames", 3, frames}, {"timeout", 4, timeout}, {"replug", 3, replug},
               {"cancel", 2, cancel}, {"calibration", 2, calibration}, {"pins", 0, pins}};
  for (size_t i = 0; argc > 1 && i < sizeof verbs / sizeof *verbs; ++i)
    if (strcmp(argv[1], verbs[i].name) == 0 && argc - 2 >= verbs[i].least)
      return verbs[i].run(argv + 2);
  fprintf(stderr, "usage: ada4571-kernel-probe VERB ARGUMENT...\n");
  return 2;
}
