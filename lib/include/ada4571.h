/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * libada4571: angles from analog sine/cosine angle sensors (ADA4571 and its kind) on Linux.
 *
 * Conventions, said once
 * ----------------------
 * 1. Handles are opaque, one noun a section. `_new`, `_open` and `_load` make one, the `_free` of
 *    the same noun ends it; every `_free` accepts NULL. A handle never depends on the life of
 *    another: what it needs it copies or shares.
 * 2. Every function that can fail returns an ada4571_status; results come through the trailing
 *    pointers, which are left untouched on failure. A NULL where a value is needed is
 *    ADA4571_ERROR_INVALID_ARGUMENT, never a crash.
 * 3. ada4571_last_error() gives the sentence for the last failure in the calling thread.
 * 4. The library never prints, never exits, installs no signal handler, and lets no exception out.
 * 5. Threads: different handles may be used in different threads at once. One handle may be used
 *    by one thread at a time, but for the functions marked "Thread-safety:".
 * 6. Units are in the names: _s seconds, _v volts, _deg degrees, _rad radians, _hz hertz.
 *    VSIN and VCOS are absolute volts as the converter sees them. `angle_deg` is mechanical and in
 *    [0, 360/p), with p the electrical periods a turn (2 for AMR, 1 for GMR, TMR and Hall): the
 *    sensor cannot tell the p parts of a turn apart. It grows when psi of
 *    VSIN = VDD/2 + A sin(psi), VCOS = VDD/2 + A cos(psi), psi = p * angle, grows.
 * 7. A channel that does not exist is NaN in a frame.
 * 8. Strings given back are UTF-8, owned by the handle they come from, and live until it is freed
 *    or the same function is called again on it.
 * 9. Structs that callers fill begin with `struct_size`; initialise them with the `_init` function
 *    of the same name, then set what you need. Enums only ever grow at the end.
 */
#ifndef ADA4571_H
#define ADA4571_H

#include <stddef.h>
#include <stdint.h>

#define ADA4571_VERSION_MAJOR 1
#define ADA4571_VERSION_MINOR 0
#define ADA4571_VERSION_PATCH 0

#if defined(__GNUC__)
#define ADA4571_API __attribute__((visibility("default")))
#else
#define ADA4571_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------ status */

typedef enum ada4571_status {
  ADA4571_OK = 0,
  ADA4571_ERROR_INVALID_ARGUMENT = 1, /* NULL, out of range, unknown name: the caller's mistake */
  ADA4571_ERROR_STATE = 2,            /* right call, wrong moment */
  ADA4571_ERROR_NO_MEMORY = 3,
  ADA4571_ERROR_IO = 4,        /* the system refused; the message has its reason */
  ADA4571_ERROR_FORMAT = 5,    /* a file or stream is not what it should be; message has the place */
  ADA4571_ERROR_NOT_FOUND = 6, /* no such file, device, channel, line */
  ADA4571_ERROR_PERMISSION = 7,
  ADA4571_ERROR_BUSY = 8,
  ADA4571_ERROR_DISCONNECTED = 9,  /* device removed or server gone; start again to re-open */
  ADA4571_ERROR_UNSUPPORTED = 10,  /* built without it, or the device cannot do it */
  ADA4571_ERROR_UNUSABLE_DATA = 11, /* refused, with the reason: coverage, clipping, stuck, ... */
  ADA4571_ERROR_INTERNAL = 99       /* a defect of the library */
} ada4571_status;

/* Name of a status, "ADA4571_OK" and so on. Never NULL. Thread-safety: any thread. */
ADA4571_API const char *ada4571_status_name(ada4571_status status);

/* Sentence for the last failure in the calling thread; empty when none. Never NULL; lives until
 * the next call of this library in the same thread. */
ADA4571_API const char *ada4571_last_error(void);

/* Version of the library that is running, "1.0.0". */
ADA4571_API const char *ada4571_version(void);

/* Progress from 0 to 1 and what is being done; called in the calling thread. Returning non-zero
 * ends the work with ADA4571_ERROR_STATE. */
typedef int (*ada4571_progress)(double fraction, const char *what, void *user);

/* Threads that one call may use for long recordings; 0, and from the start: as many as the process
 * may run on. Results do not depend on it. Thread-safety: any thread. */
ADA4571_API void ada4571_set_jobs(unsigned jobs);

/* ------------------------------------------------------------------- frame */

/* One sample of every channel. */
typedef struct ada4571_frame {
  double time_s;        /* seconds; for a device: since the first frame, from its timestamps */
  double vsin_v;        /* absolute volts */
  double vcos_v;        /* absolute volts */
  double vtemp_v;       /* absolute volts, NaN when not recorded */
  double vdd_v;         /* volts, NaN when not recorded */
  double reference_deg; /* mechanical degrees of a reference encoder, NaN when not recorded */
} ada4571_frame;

/* One angle. */
typedef struct ada4571_angle {
  double time_s;
  double angle_deg; /* mechanical, [0, 360/p); NaN when status says that there is none */
  double radius;    /* relative to the calibrated amplitude: 1 for a sound sample */
  uint32_t status;  /* 0 when sound, else ADA4571_SAMPLE_ bits */
} ada4571_angle;

enum {
  ADA4571_SAMPLE_RADIUS = 1u << 0,  /* radius outside its band: broken wire, short, no magnet */
  ADA4571_SAMPLE_RAIL = 1u << 1,    /* a channel sits at a rail */
  ADA4571_SAMPLE_INVALID = 1u << 2, /* not a number, or missing */
  ADA4571_SAMPLE_GAP = 1u << 3      /* samples are missing before this one */
};

/* ------------------------------------------------------------------ source */
/* Where frames come from: an IIO device by libiio (local or network), a recording, or the
 * simulated sensor. */

typedef struct ada4571_source ada4571_source;
typedef struct ada4571_device_list ada4571_device_list;
typedef struct ada4571_recording ada4571_recording;   /* section recording */
typedef struct ada4571_model ada4571_model;           /* section model */
typedef struct ada4571_simulation ada4571_simulation; /* section simulation */

typedef struct ada4571_source_options {
  size_t struct_size;
  const char *uri;          /* "local:", "ip:host", "ip:host:port", "usb:..."; NULL: local: */
  const char *device;       /* name, label or id of the IIO device; NULL: the only usable one */
  const char *sin_channel;  /* id, name or label of the channel; NULL: by label, vsin ... */
  const char *cos_channel;  /* ... vcos */
  const char *temp_channel; /* ... vtemp, absent allowed */
  const char *vdd_channel;  /* ... vdd, absent allowed */
  const char *trigger;      /* trigger to use; NULL: leave what is set */
  double sample_rate_hz;    /* 0: leave what is set; a source that never starts sets it back */
  double supply_v;          /* 5.0 */
  int periods_per_turn;     /* 2 */
  size_t buffer_frames;     /* frames a buffer; 0: as many as latency_s allows */
  double latency_s; /* longest time that a frame waits for its buffer to fill; 0: 0.05. Each buffer
                     * is a wake-up: a short one gives fresh angles, a long one costs little
                     * processor time; iio-angle-read(1) measures both */
} ada4571_source_options;

typedef struct ada4571_source_info {
  size_t struct_size;
  const char *description;
  const char *serial; /* empty where unknown */
  double sample_rate_hz; /* 0 where unknown */
  double supply_v;
  int periods_per_turn;
  int has_vtemp, has_vdd, has_reference;
  int gain_control; /* 1 on, 0 off, -1 unknown */
  size_t buffer_frames; /* frames a buffer from the next start on; 0: a source without buffers */
  int timestamp_clock;  /* clockid_t that the device's timestamps are of; -1: there are none, or they
                         * are of another machine */
} ada4571_source_info;

typedef struct ada4571_source_statistics {
  size_t struct_size;
  uint64_t frames; /* delivered since start */
  uint64_t lost;   /* missing, counted from the timestamps */
  uint64_t gaps;   /* places where frames are missing */
  int64_t first_timestamp_ns; /* the device's own of the frame at time_s = 0; 0 where it has none. By
                               * timestamp_clock it tells how old a frame is */
  /* Frames whose timestamp made no sense: it stood still for a second, went back, or ran a minute
   * ahead of this machine's clock. Their times go on by the sample rate; where they are more than one
   * in a hundred nothing is counted as lost. */
  uint64_t bad_times;
} ada4571_source_statistics;

/* Frames of a device that stay as it gave them; see ada4571_source_read_block(). */
typedef struct ada4571_block {
  size_t struct_size;
  size_t count;                     /* frames */
  double first_time_s, last_time_s; /* of the first and the last of them */
} ada4571_block;

typedef enum ada4571_read_outcome {
  ADA4571_READ_FRAMES = 0,    /* at least one frame */
  ADA4571_READ_TIMEOUT = 1,   /* none in time; an ordinary event, read again */
  ADA4571_READ_END = 2,       /* the source is exhausted */
  ADA4571_READ_CANCELLED = 3  /* ada4571_source_cancel() was called */
} ada4571_read_outcome;

ADA4571_API void ada4571_source_options_init(ada4571_source_options *options);
ADA4571_API void ada4571_source_info_init(ada4571_source_info *info);
ADA4571_API void ada4571_source_statistics_init(ada4571_source_statistics *statistics);
ADA4571_API void ada4571_block_init(ada4571_block *block);

/* Opens what the stored configuration NAME describes: NAME.toml in the user's configuration
 * folder ($XDG_CONFIG_HOME/ada4571, ~/.config/ada4571), then in /etc/ada4571. A NAME with a slash
 * is a path. */
ADA4571_API ada4571_status ada4571_open(const char *name, ada4571_source **source);
ADA4571_API ada4571_status ada4571_source_open(const ada4571_source_options *options,
                                               ada4571_source **source);
/* Plays a recording back, as fast as it is read. */
ADA4571_API ada4571_status ada4571_source_open_recording(const ada4571_recording *recording,
                                                         ada4571_source **source);
/* Plays it back as the device would have given it: by its own times, `speed` times as fast (1: as
 * recorded; above 0, up to 1e6). Its frames keep the times that were recorded. */
ADA4571_API ada4571_status ada4571_source_open_replay(const ada4571_recording *recording,
                                                      double speed, ada4571_source **source);
/* The simulated sensor. realtime != 0 paces it by the clock. */
ADA4571_API ada4571_status ada4571_source_open_simulation(const ada4571_simulation *simulation,
                                                          int realtime, ada4571_source **source);
ADA4571_API ada4571_status ada4571_source_get_info(const ada4571_source *source,
                                                   ada4571_source_info *info);
/* Begins the capture; again after a loss, a cancel or a stop begins it anew. */
ADA4571_API ada4571_status ada4571_source_start(ada4571_source *source);
/* Frames a buffer from the next start on, 0: by the options. ADA4571_ERROR_UNSUPPORTED for a source
 * that is no device. */
ADA4571_API ada4571_status ada4571_source_set_buffer(ada4571_source *source, size_t frames);
/* Reads up to `capacity` frames; fewer is ordinary. Waits at most timeout_ms for the first
 * (0: do not wait, negative: for ever). `count` and `outcome` are written on ADA4571_OK. For a
 * device it neither allocates memory nor waits for a lock of another thread. */
ADA4571_API ada4571_status ada4571_source_read(ada4571_source *source, ada4571_frame *frames,
                                               size_t capacity, int timeout_ms, size_t *count,
                                               ada4571_read_outcome *outcome);
/* Reads as ada4571_source_read() does, but converts no sample: the frames stay in the source until the
 * next read, start or stop, for ada4571_writer_write_block(). `block` and `outcome` are written on
 * ADA4571_OK. ADA4571_ERROR_UNSUPPORTED for a source that is no device, or one without timestamps. */
ADA4571_API ada4571_status ada4571_source_read_block(ada4571_source *source, size_t capacity,
                                                     int timeout_ms, ada4571_block *block,
                                                     ada4571_read_outcome *outcome);
/* time_s of frame `index` of the block that was read last. */
ADA4571_API ada4571_status ada4571_source_block_time(const ada4571_source *source, size_t index,
                                                     double *time_s);
/* A descriptor for poll, epoll or an event loop, of any source. While it is readable (POLLIN) a read
 * with timeout_ms 0 has something to tell: frames, the end, a cancel, or a loss. After that read it
 * stays readable until one gives ADA4571_READ_TIMEOUT; the first after start may be for nothing. At
 * the end, when cancelled and after an error it stays readable until the next start: stop watching
 * it then, or start again. It is the same from the first call to ada4571_source_free(), which closes
 * it; do not read it, and do not close it. Any thread may wait for it while one reads
 * (the documentation's "Event loops"). */
ADA4571_API ada4571_status ada4571_source_get_fd(ada4571_source *source, int *fd);
/* Makes a read in another thread return at once, and a start that waits for a server fail.
 * Thread-safety: any thread, not a signal handler. */
ADA4571_API ada4571_status ada4571_source_cancel(ada4571_source *source);
ADA4571_API ada4571_status ada4571_source_stop(ada4571_source *source);
ADA4571_API ada4571_status ada4571_source_get_statistics(const ada4571_source *source,
                                                         ada4571_source_statistics *statistics);
/* The calibration that a stored configuration names, as ada4571_model_for_source() gives it, or
 * that the driver keeps in calibbias and calibscale; ADA4571_ERROR_NOT_FOUND when there is none. By
 * the kernel's ABI a driver applies its calibbias and calibscale: the volts of such a source are
 * corrected already, and correcting them again with this model does harm (the documentation's
 * "Acquisition"). */
ADA4571_API ada4571_status ada4571_source_read_calibration(ada4571_source *source,
                                                           ada4571_model **model);
/* Writes offsets and amplitudes of the model to the driver's calibbias and calibscale:
 * calibbias = -offset / scale in whole counts, calibscale = 0.29 VDD / amplitude. All or nothing. */
ADA4571_API ada4571_status ada4571_source_write_calibration(ada4571_source *source,
                                                            const ada4571_model *model);
/* Stores how this source was opened as NAME.toml in the user's configuration folder (a NAME with
 * a slash is a path), whole or not at all. calibration_path must be a calibration that can be read;
 * NULL keeps the one that the source was opened with or NAME had before, "" stores none. Pins that
 * NAME had before are kept. */
ADA4571_API ada4571_status ada4571_source_save_config(const ada4571_source *source,
                                                      const char *name,
                                                      const char *calibration_path);
ADA4571_API void ada4571_source_free(ada4571_source *source);

/* Stored configurations, without opening what they describe. */
typedef struct ada4571_stored_list ada4571_stored_list;

typedef struct ada4571_stored {
  size_t struct_size;
  const char *name; /* for ada4571_open() */
  const char *path; /* the file */
  const char *uri, *device; /* as ada4571_source_options has them, here and below empty: not said */
  const char *sin_channel, *cos_channel, *temp_channel, *vdd_channel;
  const char *calibration_file;
  const char *problem; /* why the file cannot be used; else empty */
} ada4571_stored;

ADA4571_API void ada4571_stored_init(ada4571_stored *stored);
/* That of `name` alone, which must be usable; NULL: all that ada4571_open() finds by a name, in
 * alphabetical order. */
ADA4571_API ada4571_status ada4571_stored_list_new(const char *name, ada4571_stored_list **list);
ADA4571_API size_t ada4571_stored_list_count(const ada4571_stored_list *list);
/* The strings live as long as the list. */
ADA4571_API ada4571_status ada4571_stored_list_get(const ada4571_stored_list *list, size_t index,
                                                   ada4571_stored *stored);
ADA4571_API void ada4571_stored_list_free(ada4571_stored_list *list);

/* Devices of a context with a usable pair of channels. */
typedef struct ada4571_device {
  size_t struct_size;
  const char *id;       /* iio:device0 */
  const char *name;     /* ad7380 */
  const char *label;    /* from the device tree, empty where there is none */
  const char *channels; /* "voltage0 (vsin), voltage1 (vcos)" */
  const char *sin_channel, *cos_channel, *temp_channel, *vdd_channel; /* ids, empty when unknown */
  int labelled; /* whether the labels name the pair, so that no option is needed */
} ada4571_device;

ADA4571_API ada4571_status ada4571_device_list_new(const char *uri, ada4571_device_list **list);
ADA4571_API size_t ada4571_device_list_count(const ada4571_device_list *list);
/* The strings live as long as the list. */
ADA4571_API ada4571_status ada4571_device_list_get(const ada4571_device_list *list, size_t index,
                                                   ada4571_device *device);
ADA4571_API void ada4571_device_list_free(ada4571_device_list *list);

/* --------------------------------------------------------------- recording */
/* A capture: text (.csv) or SigMF (.sigmf-meta with .sigmf-data; either name will do). "-" is
 * standard input or output, in the text form. Both forms: ada4571-capture(5). */

typedef struct ada4571_writer ada4571_writer;
typedef struct ada4571_file ada4571_file;

typedef struct ada4571_recording_info {
  size_t struct_size;
  size_t samples;
  double duration_s;
  double supply_v;
  int periods_per_turn;
  int gain_control;      /* 1 on, 0 off, -1 unknown */
  double noise_rms_v;    /* NaN where unknown, likewise below */
  double sample_rate_hz;
  double adc_bits;
  double adc_reference_v;
  int has_vtemp, has_vdd, has_reference;
  const char *serial, *origin; /* may be NULL when given to a writer */
  const char *data_file; /* SigMF: the file that holds the samples; else empty. A writer ignores it */
} ada4571_recording_info;

ADA4571_API void ada4571_recording_info_init(ada4571_recording_info *info);

/* Reads and validates the whole file; the message of an error names file, line and column (the
 * sample in a SigMF data file). Times may repeat but not decrease; every number is finite.
 * ADA4571_ERROR_FORMAT for a malformed file, ADA4571_ERROR_NOT_FOUND, _PERMISSION or _IO. */
ADA4571_API ada4571_status ada4571_recording_open(const char *path, ada4571_recording **recording);
ADA4571_API ada4571_status ada4571_recording_get_info(const ada4571_recording *recording,
                                                      ada4571_recording_info *info);
/* Value of a metadata key, those of the info included, NULL where it is absent. */
ADA4571_API const char *ada4571_recording_metadata(const ada4571_recording *recording,
                                                   const char *key);
/* Copies frames [first, first + capacity) as far as they exist. */
ADA4571_API ada4571_status ada4571_recording_read(const ada4571_recording *recording, size_t first,
                                                  ada4571_frame *frames, size_t capacity,
                                                  size_t *count);
/* Writes it to another file, in the form that the extension names. */
ADA4571_API ada4571_status ada4571_recording_save(const ada4571_recording *recording,
                                                  const char *path);
ADA4571_API void ada4571_recording_free(ada4571_recording *recording);

/* Streaming writer. The file appears under its name only with _finish; _free without it leaves
 * nothing behind. `has_*` of the info say which columns there are; `samples` and `duration_s` are
 * not looked at. After a failed _write the file is given up: _finish is ADA4571_ERROR_STATE, as it
 * is without any frame. Volts keep every code of a converter of up to 24 bits, times the
 * nanosecond, the reference 0.0001 degrees. */
ADA4571_API ada4571_status ada4571_writer_open(const char *path, const ada4571_recording_info *info,
                                               ada4571_writer **writer);
/* The same for a recording that must survive a crash: SigMF, both files there from the first frame on
 * and readable while they grow, brought to the disk about once a second. What came stays without
 * _finish, too. Where a recording of the name is there already, the new one grows as NAME.NUMBER and
 * replaces it with _finish; with `resume` it goes on in it instead, after a gap, when supply, periods,
 * rate and channels are the same (else ADA4571_ERROR_UNUSABLE_DATA) and no other program is at it
 * (ADA4571_ERROR_BUSY). Frames then count from any time: they are moved behind those that are there. */
ADA4571_API ada4571_status ada4571_writer_open_growing(const char *path,
                                                       const ada4571_recording_info *info,
                                                       int resume, ada4571_writer **writer);
/* The same for the blocks of a device: the file holds the converter's own words, and no sample is
 * converted. What can be read of it is the same. ADA4571_ERROR_UNSUPPORTED where
 * ada4571_writer_open_growing() is to be used: for a source that gives no blocks, a device whose
 * scales a recording cannot hold, and with `resume` for a recording that was written from frames.
 * `has_*` of the info are not looked at. */
ADA4571_API ada4571_status ada4571_writer_open_blocks(const char *path,
                                                      const ada4571_recording_info *info,
                                                      const ada4571_source *source, int resume,
                                                      ada4571_writer **writer);
/* The first `count` frames of the block that `source` read last, shift_s (up to 4e9) later than they
 * say. After a failed one the file is given up, as after _write. A device that came back with other
 * channels or scales is ADA4571_ERROR_UNUSABLE_DATA. */
ADA4571_API ada4571_status ada4571_writer_write_block(ada4571_writer *writer,
                                                      const ada4571_source *source, size_t count,
                                                      double shift_s);
/* A further "# key = value" line; before the first frame. */
ADA4571_API ada4571_status ada4571_writer_metadata(ada4571_writer *writer, const char *key,
                                                   const char *value);
/* A channel of the file that is not finite, or a time before the last one, is
 * ADA4571_ERROR_INVALID_ARGUMENT. */
ADA4571_API ada4571_status ada4571_writer_write(ada4571_writer *writer, const ada4571_frame *frames,
                                                size_t count);
ADA4571_API ada4571_status ada4571_writer_finish(ada4571_writer *writer);
ADA4571_API void ada4571_writer_free(ada4571_writer *writer);

/* Measurements of other programs as frames: the CSV text of an oscilloscope or of an acquisition
 * program, with whatever stands before its rows, and numpy's .npy. What the file says of itself is
 * taken from it, the rest from the options; what cannot be told is refused rather than guessed
 * (iio-angle-import(1)). The file is read as the frames are, so that its length does not matter. */
typedef struct ada4571_import ada4571_import;

typedef struct ada4571_import_column {
  const char *column; /* its name in the file, or its number from 1; NULL: looked for by its name;
                       * "": there is none */
  double scale;       /* value = scale * number + offset, in the units of ada4571_frame; NaN: by the
                       * unit that the file gives */
  double offset;      /* 0 */
} ada4571_import_column;

typedef struct ada4571_import_options {
  size_t struct_size;
  const char *separator; /* between columns: ",", ";", "|", "\t" or " "; NULL: found out */
  const char *decimal;   /* "." or ","; NULL: found out */
  int header_lines;      /* lines before the first row; -1: found out */
  ada4571_import_column time, vsin, vcos, vtemp, vdd, reference;
  double sample_rate_hz; /* takes the place of the times; 0: by the file */
  double supply_v;       /* 5.0 */
  int periods_per_turn;  /* 2 */
} ada4571_import_options;

ADA4571_API void ada4571_import_options_init(ada4571_import_options *options);
/* ADA4571_ERROR_FORMAT with file, line and column for a file that is not understood, and
 * ADA4571_ERROR_INVALID_ARGUMENT where it can be understood in more than one way, or does not have
 * what the options name: then more options are needed. "-" is standard input. */
ADA4571_API ada4571_status ada4571_import_open(const char *path,
                                               const ada4571_import_options *options,
                                               ada4571_import **import);
/* How the file was understood, for a person: a line a channel. Empty for NULL. */
ADA4571_API const char *ada4571_import_text(const ada4571_import *import);
/* For ada4571_writer_open(). `samples` and `duration_s` are 0: nothing is known of the rows yet. */
ADA4571_API ada4571_status ada4571_import_get_info(const ada4571_import *import,
                                                   ada4571_recording_info *info);
/* The next frames, up to `capacity`; 0 at the end. Every number is finite and no time goes back;
 * ADA4571_ERROR_FORMAT with file, line and column of the one that breaks that. */
ADA4571_API ada4571_status ada4571_import_read(ada4571_import *import, ada4571_frame *frames,
                                               size_t capacity, size_t *count);
ADA4571_API void ada4571_import_free(ada4571_import *import);

/* Any other file that appears whole or not at all: it takes its name, or another's place, only with
 * _commit; _free without it leaves nothing behind. A file that is replaced hands on its permissions.
 * "-" is standard output; that, and a path that is a pipe or a device, is written as it stands.
 * After a failed _write the file is given up. */
ADA4571_API ada4571_status ada4571_file_open(const char *path, ada4571_file **file);
ADA4571_API ada4571_status ada4571_file_write(ada4571_file *file, const char *bytes, size_t count);
ADA4571_API ada4571_status ada4571_file_commit(ada4571_file *file);
ADA4571_API void ada4571_file_free(ada4571_file *file);

/* ------------------------------------------------------------------- model */
/* A model of one sensor: the application note's baseline and the effects beyond it. A calibration
 * is such a model. */

typedef struct ada4571_baseline {
  size_t struct_size;
  int periods_per_turn;
  double supply_v;       /* supply that the volts below refer to */
  double amplitude_v;    /* mean amplitude A = (A_sin + A_cos)/2 */
  double offset_sin_v;   /* about supply_v/2 */
  double offset_cos_v;
  double angle_zero_deg; /* mechanical: psi = p (alpha + zero) */
  double vtemp_reference_v; /* temperature effects act on VTEMP minus this */
} ada4571_baseline;

/* One effect of the catalogue, or one parameter of it. */
typedef struct ada4571_effect_info {
  size_t struct_size;
  const char *id;    /* "amplitude-mismatch" */
  const char *cause; /* one sentence */
  const char *stage; /* motion, field, bridge, chain, sampler, converter or record */
  int correctable;
  size_t parameters;
} ada4571_effect_info;

typedef struct ada4571_parameter {
  size_t struct_size;
  const char *name;
  const char *unit;
  double value;     /* a channel is 0 for VSIN and 1 for VCOS; NaN: not present */
  double std_error; /* NaN where unknown */
} ada4571_parameter;

ADA4571_API void ada4571_baseline_init(ada4571_baseline *baseline);
ADA4571_API void ada4571_effect_info_init(ada4571_effect_info *info);
ADA4571_API void ada4571_parameter_init(ada4571_parameter *parameter);

ADA4571_API size_t ada4571_catalogue_count(void);
ADA4571_API ada4571_status ada4571_catalogue_get(size_t index, ada4571_effect_info *info);
/* Parameter of a catalogue entry; value holds what `--effect NAME` takes by default. */
ADA4571_API ada4571_status ada4571_catalogue_parameter(size_t index, size_t parameter,
                                                       ada4571_parameter *out);
/* Values that such a parameter may have, both ends included; infinite where there is no limit. */
ADA4571_API ada4571_status ada4571_catalogue_range(size_t index, size_t parameter, double *minimum,
                                                   double *maximum);

/* An ideal sensor. */
ADA4571_API ada4571_status ada4571_model_new(const ada4571_baseline *baseline,
                                             ada4571_model **model);
/* ADA4571_ERROR_FORMAT with file, line and column for whatever is not fully understood, a wrong
 * checksum included (ada4571-model(5)). */
ADA4571_API ada4571_status ada4571_model_load(const char *path, ada4571_model **model);
/* Whole or not at all, as ada4571_file_commit. */
ADA4571_API ada4571_status ada4571_model_save(const ada4571_model *model, const char *path);
/* The model at the supply of the source, as a converter or tracker of its frames needs it: all
 * volts are fractions of VDD. ADA4571_ERROR_UNUSABLE_DATA where the two do not go together: other
 * periods a turn, or no VTEMP in the source where the model follows it. */
ADA4571_API ada4571_status ada4571_model_for_source(const ada4571_model *model,
                                                    const ada4571_source *source,
                                                    ada4571_model **out);
ADA4571_API ada4571_status ada4571_model_get_baseline(const ada4571_model *model,
                                                      ada4571_baseline *baseline);
/* Adds an effect, "stray-field" or "stray-field:b=0.01,direction_deg=30"; what is not given takes
 * the catalogue's value. ADA4571_ERROR_INVALID_ARGUMENT with the known names for an unknown one, and
 * for an effect that the model has already (at the same order, channel, moment or frequency). */
ADA4571_API ada4571_status ada4571_model_add_effect(ada4571_model *model, const char *text);
ADA4571_API size_t ada4571_model_effect_count(const ada4571_model *model);
ADA4571_API ada4571_status ada4571_model_effect(const ada4571_model *model, size_t index,
                                                ada4571_effect_info *info);
ADA4571_API ada4571_status ada4571_model_parameter(const ada4571_model *model, size_t index,
                                                   size_t parameter, ada4571_parameter *out);

/* What repeats with the angle and no effect explains: a Fourier series of each channel, which a
 * model may carry beside its effects (ada4571-model(5)). It is corrected like an effect, but it
 * has no name and is none of ada4571_model_effect. */
typedef struct ada4571_remainder {
  size_t struct_size;
  int present;          /* 0: the model has none, and the rest is 0 */
  int electrical;       /* 0: orders of the turn; 1: of psi */
  size_t highest_order;
  double rms_v;         /* of what it adds to a channel, over all angles and both channels */
} ada4571_remainder;

ADA4571_API void ada4571_remainder_init(ada4571_remainder *remainder);
ADA4571_API ada4571_status ada4571_model_get_remainder(const ada4571_model *model,
                                                       ada4571_remainder *remainder);
ADA4571_API void ada4571_model_free(ada4571_model *model);

/* ------------------------------------------------------------- calibration */
/* The application note's calibrations, with its misprints put right: the documentation's "Calibration". */

typedef enum ada4571_calibration_method {
  ADA4571_CALIBRATE_FIT = 0,     /* ellipse by maximum likelihood; needs no full turn */
  ADA4571_CALIBRATE_MEAN = 1,    /* mean over whole mechanical turns */
  ADA4571_CALIBRATE_EXTREMA = 2  /* (max + min)/2 and (max - min)/2 */
} ada4571_calibration_method;

/* Refuses data that cannot carry the method with ADA4571_ERROR_UNUSABLE_DATA and the reason. */
ADA4571_API ada4571_status ada4571_calibrate_single(const ada4571_recording *recording,
                                                    ada4571_calibration_method method,
                                                    ada4571_model **model);
/* Two temperatures: offsets (and amplitude) as straight lines over VTEMP. */
ADA4571_API ada4571_status ada4571_calibrate_dual(const ada4571_recording *cold,
                                                  const ada4571_recording *hot,
                                                  ada4571_calibration_method method,
                                                  ada4571_model **model);

/* -------------------------------------------------------------- conversion */
/* Volts in, angles out. */

typedef struct ada4571_converter ada4571_converter;

typedef enum ada4571_sample_type {
  ADA4571_S8 = 0, ADA4571_U8, ADA4571_S16, ADA4571_U16, ADA4571_S32, ADA4571_U32,
  ADA4571_F32, ADA4571_F64
} ada4571_sample_type;

/* Where the pair stands in a block of raw samples: element i of a channel is at
 * base + i * stride_bytes, native byte order. Volts = (raw + offset) * scale. */
typedef struct ada4571_layout {
  size_t struct_size;
  ada4571_sample_type type;
  size_t stride_bytes;
  double scale_v, offset; /* of both channels */
  unsigned shift; /* right shift of integers before use */
  unsigned bits;  /* significant bits after the shift, 0: all */
} ada4571_layout;

/* Greatest error of the float conversion and of ada4571_atan2_f32, in radians (electrical). */
#define ADA4571_ATAN2_F32_MAX_ERROR_RAD 1e-6

ADA4571_API void ada4571_layout_init(ada4571_layout *layout);

ADA4571_API ada4571_status ada4571_converter_new(const ada4571_model *model,
                                                 ada4571_converter **converter);
/* A live stream, block after block: dynamic effects use the speed of the frames before. No
 * allocation. */
ADA4571_API ada4571_status ada4571_converter_frames(ada4571_converter *converter,
                                                    const ada4571_frame *frames, size_t count,
                                                    ada4571_angle *angles);
/* A whole recording: the speed comes from both sides of each sample. `angles` has room for all. */
ADA4571_API ada4571_status ada4571_converter_recording(ada4571_converter *converter,
                                                       const ada4571_recording *recording,
                                                       ada4571_angle *angles);

typedef enum ada4571_angle_form {
  ADA4571_ANGLES_BY_NAME = 0, /* SigMF where the path ends in .sigmf-meta or .sigmf-data, else text */
  ADA4571_ANGLES_TEXT = 1,    /* time_s,angle_deg,radius,status in lines; "-" is standard output */
  ADA4571_ANGLES_SIGMF = 2    /* angle_deg, radius and status as 32-bit floats */
} ada4571_angle_form;

/* The same into a file, block by block and by several threads (ada4571_set_jobs): it takes no more
 * memory for a longer recording, unless the model has effects beyond the ellipse. The file appears
 * whole or not at all. `progress` may be NULL. */
ADA4571_API ada4571_status ada4571_converter_save(const ada4571_converter *converter,
                                                  const ada4571_recording *recording,
                                                  const char *path, ada4571_angle_form form,
                                                  ada4571_progress progress, void *user);
/* The vector path: raw samples to mechanical angle in radians [0, 2 pi / p), and the relative
 * radius where radius is not NULL. Offsets, mismatch and quadrature are corrected, and a periodic
 * remainder where it is the same in each of the p parts of a turn; a model with further effects is
 * ADA4571_ERROR_UNSUPPORTED here. */
ADA4571_API ada4571_status ada4571_converter_raw_f32(const ada4571_converter *converter,
                                                     const ada4571_layout *layout, const void *sin,
                                                     const void *cos, size_t count,
                                                     float *angle_rad, float *radius);
ADA4571_API ada4571_status ada4571_converter_raw_f64(const ada4571_converter *converter,
                                                     const ada4571_layout *layout, const void *sin,
                                                     const void *cos, size_t count,
                                                     double *angle_rad, double *radius);
ADA4571_API void ada4571_converter_free(ada4571_converter *converter);

/* out[i] = atan2(y[i], x[i]), vectorised for the best instruction set of this processor. Special
 * values as C's atan2; the documentation's "Conversion" has the table. */
ADA4571_API ada4571_status ada4571_atan2_f32(const float *y, const float *x, size_t count,
                                             float *out);
ADA4571_API ada4571_status ada4571_atan2_f64(const double *y, const double *x, size_t count,
                                             double *out);
/* Instruction set in use: "AVX3", "AVX2", "SSE4", "NEON", ..., "scalar". */
ADA4571_API const char *ada4571_vector_target(void);

/* ----------------------------------------------------------------- tracker */
/* Dynamic calibration: offsets (and amplitudes and phase where wanted) followed while the magnet
 * turns. Constant memory, no allocation a sample. */

typedef struct ada4571_tracker ada4571_tracker;

typedef struct ada4571_tracker_options {
  size_t struct_size;
  int track_amplitude; /* 0 */
  int track_phase;     /* 0 */
  double max_offset_rate_v_per_s; /* drift that is believed, 0.02 */
} ada4571_tracker_options;

ADA4571_API void ada4571_tracker_options_init(ada4571_tracker_options *options);
/* `model`: the end-of-line calibration, in force from the first sample. options may be NULL. */
ADA4571_API ada4571_status ada4571_tracker_new(const ada4571_model *model,
                                               const ada4571_tracker_options *options,
                                               ada4571_tracker **tracker);
ADA4571_API ada4571_status ada4571_tracker_frames(ada4571_tracker *tracker,
                                                  const ada4571_frame *frames, size_t count,
                                                  ada4571_angle *angles);
/* A recording into a file of angles, as ada4571_converter_save. */
ADA4571_API ada4571_status ada4571_tracker_save(ada4571_tracker *tracker,
                                                const ada4571_recording *recording,
                                                const char *path, ada4571_angle_form form,
                                                ada4571_progress progress, void *user);
/* The calibration in force now, as a model of its own. */
ADA4571_API ada4571_status ada4571_tracker_model(const ada4571_tracker *tracker,
                                                 ada4571_model **model);
ADA4571_API void ada4571_tracker_free(ada4571_tracker *tracker);

/* -------------------------------------------------------------------- pins */
/* The sensor's GC (gain control) and PD (power down) lines by libgpiod. */

typedef struct ada4571_pins ada4571_pins;
typedef enum ada4571_pin { ADA4571_PIN_GC = 0, ADA4571_PIN_PD = 1 } ada4571_pin;

typedef struct ada4571_pins_options {
  size_t struct_size;
  const char *config;  /* stored configuration by name; NULL: none */
  const char *gc_line; /* line name, or "chip:offset"; NULL: "ada4571-gc" */
  const char *pd_line; /* NULL: "ada4571-pd" */
  int gc_active_low, pd_active_low; /* 0 */
} ada4571_pins_options;

ADA4571_API void ada4571_pins_options_init(ada4571_pins_options *options);
ADA4571_API ada4571_status ada4571_pins_open(const ada4571_pins_options *options,
                                             ada4571_pins **pins);
/* on != 0: GC on means gain control active; PD on means powered down. Taking PD off waits for the
 * sensor to come up. The line is held, and keeps its state, as long as the handle lives. */
ADA4571_API ada4571_status ada4571_pins_set(ada4571_pins *pins, ada4571_pin pin, int on);
/* What was set through this handle, else what the line reads. */
ADA4571_API ada4571_status ada4571_pins_get(ada4571_pins *pins, ada4571_pin pin, int *on);
ADA4571_API void ada4571_pins_free(ada4571_pins *pins);

/* -------------------------------------------------------------- simulation */
/* The simulated sensor: a model, a motion and a temperature, seeded. */

typedef struct ada4571_emulator ada4571_emulator;

typedef struct ada4571_simulation_options {
  size_t struct_size;
  double sample_rate_hz;     /* 10000 */
  double duration_s;         /* 7; 0: without end, for sources and the emulator */
  double noise_rms_v;        /* 0.0005 */
  int adc_bits;              /* 16; 0: not quantised */
  double adc_reference_v;    /* 5.0 */
  const char *motion;        /* iio-angle-simulate(1); "constant:rpm=600", "steps:rpm=60/600/-600" ... */
  const char *temperature;   /* "constant:deg_c=25", "ramp:from=-20,to=100", "cycle:..." */
  int gain_control;          /* 1: amplitude compensated over temperature, 0: not */
  int has_vtemp, has_vdd, has_reference; /* 1: the column exists */
} ada4571_simulation_options;

ADA4571_API void ada4571_simulation_options_init(ada4571_simulation_options *options);
/* Text of `motion` or `temperature` with its default values, one a kind ("constant:rpm=600"), NULL
 * past the last. */
ADA4571_API const char *ada4571_motion_example(size_t index);
ADA4571_API const char *ada4571_temperature_example(size_t index);
/* `model` NULL: a sound ADA4571 with offsets and their drift drawn from the seed. `options` NULL:
 * the defaults. */
ADA4571_API ada4571_status ada4571_simulation_new(const ada4571_model *model,
                                                  const ada4571_simulation_options *options,
                                                  uint64_t seed, ada4571_simulation **simulation);
/* The model in force, drawn values included. */
ADA4571_API ada4571_status ada4571_simulation_model(const ada4571_simulation *simulation,
                                                    ada4571_model **model);
ADA4571_API ada4571_status ada4571_simulation_run(const ada4571_simulation *simulation,
                                                  ada4571_recording **recording);
ADA4571_API void ada4571_simulation_free(ada4571_simulation *simulation);

/* Serves the simulated sensor as a network IIO device (protocol of libiio 0.24) on
 * 127.0.0.1:port; port 0 picks a free one. */
ADA4571_API ada4571_status ada4571_emulator_new(const ada4571_simulation *simulation, int port,
                                                ada4571_emulator **emulator);
/* The same for a recording, played `speed` times as fast as it was recorded (above 0, up to 1e6): each
 * client's buffer begins at its first sample, and after its last one nothing comes any more. */
ADA4571_API ada4571_status ada4571_emulator_new_replay(const ada4571_recording *recording,
                                                       double speed, int port,
                                                       ada4571_emulator **emulator);
ADA4571_API int ada4571_emulator_port(const ada4571_emulator *emulator);
/* Serves until _stop. */
ADA4571_API ada4571_status ada4571_emulator_run(ada4571_emulator *emulator);
/* Thread-safety: any thread, and signal handlers. */
ADA4571_API void ada4571_emulator_stop(ada4571_emulator *emulator);
ADA4571_API void ada4571_emulator_free(ada4571_emulator *emulator);

/* --------------------------------------------------------------- diagnosis */
/* What the simulation gets wrong: found, named, modelled, and its gain measured on held-out data. */

typedef struct ada4571_diagnosis ada4571_diagnosis;

typedef enum ada4571_verdict {
  ADA4571_NO_DISCREPANCY = 0,
  ADA4571_EXPLAINED = 1,
  ADA4571_PARTLY_EXPLAINED = 2,
  ADA4571_UNEXPLAINED = 3,
  ADA4571_INSUFFICIENT_DATA = 4
} ada4571_verdict;

typedef struct ada4571_diagnosis_options {
  size_t struct_size;
  const ada4571_model *baseline;    /* NULL: the application note's model */
  const char *baseline_name;        /* printed; NULL: "application note" */
  const ada4571_recording *heldout; /* NULL: whole revolutions of the capture are held out */
  ada4571_progress progress;        /* NULL: none */
  void *user;
  /* More captures to hold out, beside `heldout`; NULL and 0: none. */
  const ada4571_recording *const *more_heldout;
  size_t more_heldout_count;
} ada4571_diagnosis_options;

ADA4571_API void ada4571_diagnosis_options_init(ada4571_diagnosis_options *options);
ADA4571_API ada4571_status ada4571_diagnose(const ada4571_recording *recording,
                                            const ada4571_diagnosis_options *options,
                                            ada4571_diagnosis **diagnosis);
/* Several captures of one sensor together, `count` of them, 1 or more. Each may have another zero of
 * its reference. From three on every third is held out as a whole; of two, each is split by itself.
 * ADA4571_ERROR_INVALID_ARGUMENT where they do not go together: another supply, another number of
 * periods per turn, other channels. Times in the result go on from one capture to the next. */
ADA4571_API ada4571_status ada4571_diagnose_captures(const ada4571_recording *const *recordings,
                                                     size_t count,
                                                     const ada4571_diagnosis_options *options,
                                                     ada4571_diagnosis **diagnosis);
/* A reference that is none of the sensor's shaft - in radians, of another shaft or another number of
 * periods, standing still - is set aside: the pair is judged by itself, the verdict is not
 * ADA4571_EXPLAINED, and _reference_aside says why. */
ADA4571_API ada4571_verdict ada4571_diagnosis_verdict(const ada4571_diagnosis *diagnosis);
/* Why the reference was set aside, a sentence that lives as long as the diagnosis; NULL where it was
 * not, or there is none. */
ADA4571_API const char *ada4571_diagnosis_reference_aside(const ada4571_diagnosis *diagnosis);
/* "ada4571-diagnosis/1" */
ADA4571_API const char *ada4571_diagnosis_json(const ada4571_diagnosis *diagnosis);
/* The same for a person, plain text. */
ADA4571_API const char *ada4571_diagnosis_text(const ada4571_diagnosis *diagnosis);
/* What was found, in the order in which it was added to the model. The strings live as long as the
 * diagnosis. */
typedef struct ada4571_finding {
  size_t struct_size;
  const char *cause;       /* identifier of the catalogue */
  const char *explanation; /* one sentence for a person */
  const char *separate_by; /* the experiment that tells it from its alternatives; may be empty */
  int correctable;         /* the angle can be rid of it */
  size_t parameters, alternatives;
  /* Before and after it was added, on held-out data. The angle errors are NaN without a reference. */
  double residual_rms_before_v, residual_rms_after_v;
  double angle_error_rms_before_deg, angle_error_rms_after_deg;
  double log_likelihood_before, log_likelihood_after; /* per sample */
} ada4571_finding;

ADA4571_API void ada4571_finding_init(ada4571_finding *finding);
ADA4571_API size_t ada4571_diagnosis_finding_count(const ada4571_diagnosis *diagnosis);
ADA4571_API ada4571_status ada4571_diagnosis_finding(const ada4571_diagnosis *diagnosis,
                                                     size_t index, ada4571_finding *finding);
ADA4571_API ada4571_status ada4571_diagnosis_parameter(const ada4571_diagnosis *diagnosis,
                                                       size_t finding, size_t parameter,
                                                       ada4571_parameter *out);
/* A cause that the data cannot tell from the finding; NULL past the last, or where there is no such
 * finding. */
ADA4571_API const char *ada4571_diagnosis_alternative(const ada4571_diagnosis *diagnosis,
                                                      size_t finding, size_t alternative);
/* The extended model, ready for ada4571_converter_new. */
ADA4571_API ada4571_status ada4571_diagnosis_model(const ada4571_diagnosis *diagnosis,
                                                   ada4571_model **model);
/* One self-contained HTML page. Plots are drawn by the program gnuplot; one that it does not draw is
 * missing from the page, which says why. */
ADA4571_API ada4571_status ada4571_diagnosis_report(const ada4571_diagnosis *diagnosis,
                                                    const char *path);
ADA4571_API void ada4571_diagnosis_free(ada4571_diagnosis *diagnosis);

/* ------------------------------------------------------------------ health */

typedef struct ada4571_health ada4571_health;

/* Voltages within supply and converter, rotation, radius in its band, rails, clipping, stuck or
 * shorted channels, spikes, missing samples, noise against what capture or model states, supply.
 * `model` NULL: the ellipse that fits the capture, or where none does, a nominal ADA4571. */
ADA4571_API ada4571_status ada4571_check(const ada4571_recording *recording,
                                         const ada4571_model *model, ada4571_health **health);
/* 1 when there were samples enough to judge by and no check failed; 0 for NULL. */
ADA4571_API int ada4571_health_sound(const ada4571_health *health);
/* For a person, a line a check. Empty for NULL, likewise below. */
ADA4571_API const char *ada4571_health_text(const ada4571_health *health);
/* "ada4571-check/1": schema, sound, against, checks[] of id, state ("passed", "failed",
 * "unknown"), measured, limit, unit, explanation, times_s (of spikes). */
ADA4571_API const char *ada4571_health_json(const ada4571_health *health);
ADA4571_API void ada4571_health_free(ada4571_health *health);

/* ------------------------------------------------------------------- study */
/* Many captures, many sensors: a row each in an SQLite database, and what they have in common. A
 * capture is analysed apart from the database, so that it may be done in a process of its own. */

typedef struct ada4571_study ada4571_study;
typedef struct ada4571_study_row ada4571_study_row;

typedef struct ada4571_study_options {
  size_t struct_size;
  int diagnose;              /* 1; 0: check and calibrate only, 20 to 500 times as fast */
  int shard, shards;         /* 1 of 1: this study takes every capture, K of N those whose name falls to K */
  const char *report_folder; /* a page for each capture there; NULL: none */
  ada4571_progress progress; /* of ada4571_study_analyse, while it diagnoses; NULL: none */
  void *user;
} ada4571_study_options;

ADA4571_API void ada4571_study_options_init(ada4571_study_options *options);
/* Opens a study, or makes one. With options NULL it must be there and is only read. A study that was
 * made with another `diagnose` or another shard is ADA4571_ERROR_INVALID_ARGUMENT. */
ADA4571_API ada4571_status ada4571_study_open(const char *path,
                                              const ada4571_study_options *options,
                                              ada4571_study **study);
/* Lists captures that are to be done; those that fall to another shard, or are listed, do not count. */
ADA4571_API ada4571_status ada4571_study_list(ada4571_study *study, const char *const *captures,
                                              size_t count);
/* Those that are listed and not done, or changed since, in the order of their names; `again` != 0:
 * those that failed, or were done by another version, too. */
ADA4571_API ada4571_status ada4571_study_find_waiting(ada4571_study *study, int again, size_t *count);
/* Name of one of those that were found, NULL past the last. */
ADA4571_API const char *ada4571_study_waiting(const ada4571_study *study, size_t index);
/* Checks, calibrates and diagnoses one capture. One that cannot be read or diagnosed is a row with
 * its reason, and no failure; what `progress` ends is no row. Thread-safety: any thread. */
ADA4571_API ada4571_status ada4571_study_analyse(const char *capture,
                                                 const ada4571_study_options *options,
                                                 ada4571_study_row **row);
/* The row of a capture whose analysis came to nothing, with the reason. */
ADA4571_API ada4571_status ada4571_study_row_failed(const char *capture, const char *reason,
                                                    ada4571_study_row **row);
/* The row as text (JSON, for ada4571_study_put of any process), and the reason why there is not
 * more in it, empty where it is whole. */
ADA4571_API const char *ada4571_study_row_text(const ada4571_study_row *row);
ADA4571_API const char *ada4571_study_row_reason(const ada4571_study_row *row);
ADA4571_API void ada4571_study_row_free(ada4571_study_row *row);
/* Puts a row into the study, in the place of an older one of the same capture; on the disk when it
 * returns. */
ADA4571_API ada4571_status ada4571_study_put(ada4571_study *study, const char *row_text);
/* Makes one study of several, whole or not at all. The file is the same, byte for byte, whatever the
 * order of the parts, however the captures were dealt out, and if some are given twice. A shard whose
 * captures were never listed (its process was killed) is missing in it; a study of all captures in
 * that state is INVALID_ARGUMENT, as nothing would show what it lacks. */
ADA4571_API ada4571_status ada4571_study_merge(const char *const *parts, size_t count,
                                               const char *path);
/* What is missing: shards that are not there and captures that wait, a line each. Empty: nothing. */
ADA4571_API const char *ada4571_study_missing(ada4571_study *study);
/* "ada4571-study/1", the same for a person, and as one self-contained HTML page with plots as
 * ada4571_diagnosis_report draws them. */
ADA4571_API ada4571_status ada4571_study_json(ada4571_study *study, const char **json);
ADA4571_API ada4571_status ada4571_study_text(ada4571_study *study, const char **text);
ADA4571_API ada4571_status ada4571_study_report(ada4571_study *study, const char *path);
ADA4571_API void ada4571_study_free(ada4571_study *study);

/* ------------------------------------------------------------------ figures */

/* Figures of the application note, reproduced by the simulation as data: "mismatch" (Fig. 6),
 * "offset-25", "offset-0-110", "offset-20-80", "offset-20-50" (Figs. 8 to 11), "error-gc-on",
 * "error-gc-off" (Figs. 2, 3). Writes DIRECTORY/NAME.csv, and NAME.svg where gnuplot is found. */
ADA4571_API ada4571_status ada4571_figure_write(const char *name, uint64_t seed,
                                                const char *directory);
/* Name of figure `index`, NULL past the last. */
ADA4571_API const char *ada4571_figure_name(size_t index);

#ifdef __cplusplus
}
#endif

#endif /* ADA4571_H */
