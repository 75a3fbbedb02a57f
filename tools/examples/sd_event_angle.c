/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * sd_event_angle CAPTURE: a source in the event loop of systemd (libsystemd), as a daemon has it.
 * Prints the mean of each batch of frames and ends with the capture, or on SIGTERM.
 */
#define _POSIX_C_SOURCE 200809L
#include <ada4571.h>
#include <signal.h>
#include <stdio.h>
#include <sys/epoll.h>
#include <systemd/sd-event.h>

/* One read a turn of the loop: the descriptor stays readable while there is more. */
static int on_readable(sd_event_source *event, int fd, uint32_t revents, void *user) {
  ada4571_source *source = user;
  ada4571_frame frames[512];
  ada4571_read_outcome outcome = ADA4571_READ_END;
  size_t n = 0, i = 0;
  double sin_v = 0, cos_v = 0;
  (void)fd;
  (void)revents;
  if (ada4571_source_read(source, frames, 512, 0, &n, &outcome)) {
    fprintf(stderr, "%s\n", ada4571_last_error());
    return sd_event_exit(sd_event_source_get_event(event), 1);
  }
  if (outcome == ADA4571_READ_END || outcome == ADA4571_READ_CANCELLED)
    return sd_event_exit(sd_event_source_get_event(event), 0);
  for (i = 0; i < n; i++) {
    sin_v += frames[i].vsin_v / (double)n;
    cos_v += frames[i].vcos_v / (double)n;
  }
  if (n > 0) printf("%8.3f s %7.4f V %7.4f V\n", frames[n - 1].time_s, sin_v, cos_v);
  return 0;
}

/* Both signals end the loop; they must be blocked before any thread is started. */
static int watch_signals(sd_event *loop) {
  sigset_t signals;
  int failed = 0;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, NULL);
  failed = sd_event_add_signal(loop, NULL, SIGINT, NULL, NULL);
  return failed < 0 ? failed : sd_event_add_signal(loop, NULL, SIGTERM, NULL, NULL);
}

int main(int argc, char **argv) {
  sd_event *loop = NULL;
  ada4571_recording *recording = NULL;
  ada4571_source *source = NULL;
  int fd = -1, result = 1;
  ada4571_status status = ada4571_recording_open(argc > 1 ? argv[1] : "capture.csv", &recording);
  if (!status) status = ada4571_source_open_replay(recording, 1.0, &source);
  if (!status) status = ada4571_source_get_fd(source, &fd);
  if (!status && sd_event_default(&loop) >= 0 && watch_signals(loop) >= 0 &&
      sd_event_add_io(loop, NULL, fd, EPOLLIN, on_readable, source) >= 0) {
    status = ada4571_source_start(source);
    if (!status) result = sd_event_loop(loop);
  }
  if (status) fprintf(stderr, "%s\n", ada4571_last_error());
  sd_event_unref(loop);
  ada4571_source_free(source);
  ada4571_recording_free(recording);
  return result < 0 ? 1 : result;
}
