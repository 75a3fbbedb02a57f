// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/child_process.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/descriptor.h"

extern char **environ;

namespace ada {

namespace {

using Clock = std::chrono::steady_clock;

/// The input as an unnamed file: unlike a pipe it cannot raise SIGPIPE in the host, and neither
/// side ever waits for the other.
Descriptor memory_file(const std::string &program, std::string_view text) {
  Descriptor fd(::memfd_create("input", MFD_CLOEXEC));
  if (fd.get() < 0)
    throw system_error(errno, program, "cannot hand over its input");
  while (!text.empty()) {
    const ssize_t n = ::write(fd.get(), text.data(), text.size());
    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0)
      throw system_error(errno, program, "cannot hand over its input");
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  ::lseek(fd.get(), 0, SEEK_SET);
  return fd;
}

struct Pipe {
  Descriptor read, write;
};

Pipe make_pipe(const std::string &program) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw system_error(errno, program, "cannot run");
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// Ends and reaps the child on every way out.
class Child {
public:
  explicit Child(pid_t pid) : pid_(pid) {}
  Child(const Child &) = delete;
  Child &operator=(const Child &) = delete;
  ~Child() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      wait();
    }
  }
  int wait() {
    int status = 0;
    pid_t got;
    do
      got = ::waitpid(pid_, &status, 0);
    while (got < 0 && errno == EINTR);
    pid_ = -1;
    // A host that ignores SIGCHLD has had the status taken away.
    return got > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

private:
  pid_t pid_;
};

pid_t spawn(const std::string &program, const std::vector<std::string> &arguments, int in, int out,
            int err) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  sigset_t none, all;
  ::sigemptyset(&none);
  ::sigfillset(&all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<char *> argv{const_cast<char *>(program.c_str())};
  for (const std::string &a : arguments)
    argv.push_back(const_cast<char *>(a.c_str()));
  argv.push_back(nullptr);
  pid_t pid = -1;
  const int failure =
      ::posix_spawnp(&pid, program.c_str(), &actions, &attributes, argv.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0)
    throw system_error(failure, program, "cannot run");
  return pid;
}

} // namespace

ChildResult run_child(const std::string &program, const std::vector<std::string> &arguments,
                      std::string_view input, const ChildLimits &limits) {
  const Descriptor in = memory_file(program, input);
  Pipe out = make_pipe(program), err = make_pipe(program);
  Child child(spawn(program, arguments, in.get(), out.write.get(), err.write.get()));
  out.write = Descriptor();
  err.write = Descriptor();

  ChildResult result;
  std::string *const text[] = {&result.out, &result.err};
  std::array<pollfd, 2> ends{{{out.read.get(), POLLIN, 0}, {err.read.get(), POLLIN, 0}}};
  const auto deadline = Clock::now() + std::chrono::milliseconds(limits.timeout_ms);
  char block[1 << 16];
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0)
      throw Error(ADA4571_ERROR_IO, program + ": no answer within " +
                                        std::to_string(limits.timeout_ms / 1000) + " s");
    if (::poll(ends.data(), ends.size(), static_cast<int>(left)) < 0) {
      if (errno != EINTR)
        throw system_error(errno, program, "cannot read from it");
      continue; // POSIX does not say what an interrupted poll leaves in revents
    }
    for (std::size_t k = 0; k < ends.size(); ++k) {
      if (ends[k].fd < 0 || ends[k].revents == 0)
        continue;
      const ssize_t n = ::read(ends[k].fd, block, sizeof block);
      if (n > 0)
        text[k]->append(block, static_cast<std::size_t>(n));
      else if (n == 0 || errno != EINTR)
        ends[k].fd = -1;
      if (text[k]->size() > limits.output_bytes)
        throw Error(ADA4571_ERROR_IO, program + ": writes more than it should");
    }
  }
  result.exit_status = child.wait();
  return result;
}

} // namespace ada
