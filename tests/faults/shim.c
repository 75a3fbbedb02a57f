/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * LD_PRELOAD library that makes one system call of a program go wrong: the FAULT_AT-th FAULT_CALL
 * (open, write, room, fsync, rename, link, truncate; room is fallocate). FAULT_HOW is the number of
 * an errno, "kill" to end the program before the call, "killed" to end it after. With FAULT_ON
 * every later call fails as well, as on a disk that is full. FAULT_LOG is a file that gets a line a
 * call, to know how many there are. With FAULT_SHRINK=N a recording's data file is cut short before
 * it is read for the Nth time. Counted is only what changes files: opens for writing, writes to
 * regular files and to standard output. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_int calls;

static void log_call(const char *name) {
  const char *path = getenv("FAULT_LOG");
  int fd = path ? (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_APPEND | O_CREAT, 0666) : -1;
  if (fd < 0)
    return;
  syscall(SYS_write, fd, name, strlen(name));
  syscall(SYS_write, fd, "\n", (size_t)1);
  syscall(SYS_close, fd);
}

static void end_program(void) {
  syscall(SYS_kill, getpid(), SIGKILL);
}

/* 0: go on; 1: go on, then end; -1: fail with errno. */
static int fault(const char *name) {
  const char *call = getenv("FAULT_CALL"), *at = getenv("FAULT_AT"), *how = getenv("FAULT_HOW");
  log_call(name);
  if (!call || !at || !how || strcmp(call, name) != 0)
    return 0;
  const int now = atomic_fetch_add(&calls, 1) + 1, wanted = atoi(at);
  if (now != wanted && !(getenv("FAULT_ON") && now > wanted))
    return 0;
  if (strcmp(how, "kill") == 0)
    end_program();
  if (strcmp(how, "killed") == 0)
    return 1;
  errno = atoi(how);
  return -1;
}

/* Runs the real call between the two halves of a fault. */
#define FAULTY(type, name, counted, real)                                                          \
  do {                                                                                             \
    const int what = (counted) ? fault(name) : 0;                                                  \
    if (what < 0)                                                                                  \
      return (type)-1;                                                                             \
    const type result = (type)(real);                                                              \
    const int reason = errno;                                                                      \
    if (what > 0)                                                                                  \
      end_program();                                                                               \
    errno = reason;                                                                                \
    return result;                                                                                 \
  } while (0)

static int is_counted(int fd) {
  struct stat info;
  return fd == STDOUT_FILENO || (fd > STDERR_FILENO && fstat(fd, &info) == 0 && S_ISREG(info.st_mode));
}

int open(const char *path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, int) : 0;
  va_end(arguments);
  const int writes = (flags & O_ACCMODE) != O_RDONLY && strncmp(path, "/dev/", 5) != 0;
  FAULTY(int, "open", writes, syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

ssize_t write(int fd, const void *bytes, size_t count) {
  FAULTY(ssize_t, "write", is_counted(fd), syscall(SYS_write, fd, bytes, count));
}

ssize_t writev(int fd, const struct iovec *pieces, int count) {
  FAULTY(ssize_t, "write", is_counted(fd), syscall(SYS_writev, fd, pieces, (long)count));
}

int fallocate(int fd, int mode, off_t from, off_t length) {
  FAULTY(int, "room", 1, syscall(SYS_fallocate, fd, mode, from, length));
}

int fallocate64(int fd, int mode, off_t from, off_t length) {
  return fallocate(fd, mode, from, length);
}

int fsync(int fd) {
  FAULTY(int, "fsync", 1, syscall(SYS_fsync, fd));
}

int fdatasync(int fd) {
  FAULTY(int, "fsync", 1, syscall(SYS_fdatasync, fd));
}

int rename(const char *from, const char *to) {
  FAULTY(int, "rename", 1, syscall(SYS_rename, from, to));
}

int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags) {
  FAULTY(int, "link", 1, syscall(SYS_linkat, from_folder, from, to_folder, to, flags));
}

int ftruncate(int fd, off_t length) {
  FAULTY(int, "truncate", 1, syscall(SYS_ftruncate, fd, length));
}

/* The data file of a recording is cut short before the read of it that FAULT_SHRINK counts to. */
static void shrink(int fd) {
  static atomic_int reads;
  const char *when = getenv("FAULT_SHRINK");
  char link[64], path[4096] = "";
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  if (when && readlink(link, path, sizeof path - 1) > 0 && strstr(path, ".sigmf-data") &&
      atomic_fetch_add(&reads, 1) + 1 == atoi(when))
    syscall(SYS_truncate, path, (off_t)1000);
}

ssize_t pread(int fd, void *bytes, size_t count, off_t offset) {
  shrink(fd);
  return syscall(SYS_pread64, fd, bytes, count, offset);
}

ssize_t pread64(int fd, void *bytes, size_t count, off_t offset) {
  return pread(fd, bytes, count, offset);
}
