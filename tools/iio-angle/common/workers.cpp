// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/workers.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/handles.h"

namespace cli {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWorkDone = 0, kWorkFailed = 3;

[[noreturn]] void fail(const char *what) {
  throw Failure(kUnusable, fmt::format("cannot {}: {}", what, std::strerror(errno)));
}

struct Fd {
  int fd = -1;
  explicit Fd(int f = -1) : fd(f) {}
  Fd(Fd &&other) noexcept : fd(std::exchange(other.fd, -1)) {}
  Fd &operator=(Fd &&other) noexcept {
    std::swap(fd, other.fd);
    return *this;
  }
  ~Fd() {
    if (fd >= 0)
      close(fd);
  }
};

/// The signals that end the work come through a descriptor, to be waited for with the pipes.
class Signals {
public:
  Signals() {
    sigset_t wanted;
    sigemptyset(&wanted);
    for (const int s : {SIGINT, SIGTERM, SIGHUP})
      sigaddset(&wanted, s);
    sigprocmask(SIG_BLOCK, &wanted, &before_);
    fd_ = Fd(signalfd(-1, &wanted, SFD_CLOEXEC | SFD_NONBLOCK));
    if (fd_.fd < 0)
      fail("wait for signals");
  }
  ~Signals() { restore(); }
  void restore() const { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  int fd() const { return fd_.fd; }
  /// Whether one came; it is taken, so that it does not end the program when it is let in again.
  bool came() const {
    signalfd_siginfo which;
    return read(fd_.fd, &which, sizeof which) == static_cast<ssize_t>(sizeof which);
  }

private:
  sigset_t before_{};
  Fd fd_;
};

struct Process {
  std::size_t piece;
  pid_t pid;
  Fd pipe;
  Clock::time_point end;
  std::string text{};
  bool late = false;
};

bool write_whole(int fd, const std::string &text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = write(fd, text.data() + at, text.size() - at);
    if (n < 0 && errno != EINTR)
      return false;
    at += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  return true;
}

/// The rest of the worker's life. Its own group, so that what it starts ends with it; and it never
/// outlives the program.
[[noreturn]] void live_as_worker(const Work &work, std::size_t piece, int fd, pid_t parent,
                                 const Signals &signals) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent)
    _exit(kWorkFailed);
  for (const int s : {SIGINT, SIGTERM, SIGHUP})
    signal(s, SIG_DFL);
  signals.restore();
  int status = kWorkDone;
  std::string text;
  try {
    text = work.run(piece);
  } catch (const std::exception &e) {
    text = e.what();
    status = kWorkFailed;
  }
  if (!write_whole(fd, text))
    status = kWorkFailed;
  _exit(status);
}

Process start(const Work &work, std::size_t piece, const Signals &signals) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    fail("make a pipe");
  Fd reader(ends[0]), writer(ends[1]);
  const pid_t parent = getpid(), pid = fork();
  if (pid < 0)
    fail("start a process");
  if (pid == 0)
    live_as_worker(work, piece, writer.fd, parent, signals);
  setpgid(pid, pid); // whoever comes first
  fcntl(reader.fd, F_SETFL, O_NONBLOCK);
  const auto limit = work.limit_s > 0.0
                         ? Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(work.limit_s))
                         : Clock::time_point::max();
  return {piece, pid, std::move(reader), limit};
}

/// Takes what is there; false at the end of the pipe.
bool drain(Process &p) {
  char buffer[65536];
  for (;;) {
    const ssize_t n = read(p.pipe.fd, buffer, sizeof buffer);
    if (n > 0)
      p.text.append(buffer, static_cast<std::size_t>(n));
    else if (n == 0 || (errno != EAGAIN && errno != EINTR))
      return false;
    else if (errno == EAGAIN)
      return true;
  }
}

void kill_group(const Process &p) {
  if (kill(-p.pid, SIGKILL) != 0)
    kill(p.pid, SIGKILL);
}

void finish(const Work &work, Process &p) {
  int status = 0;
  while (waitpid(p.pid, &status, 0) < 0 && errno == EINTR) {
  }
  std::string why;
  if (p.late)
    why = fmt::format("the analysis took longer than {:g} s", work.limit_s);
  else if (WIFSIGNALED(status))
    why = fmt::format("the analysis crashed: {}", strsignal(WTERMSIG(status)));
  else if (WEXITSTATUS(status) != kWorkDone)
    why = p.text.empty() ? fmt::format("the analysis ended with {}", WEXITSTATUS(status)) : p.text;
  work.ended(p.piece, p.text, why);
}

/// Until a pipe or a signal has something, or the next limit is reached; false for a signal.
bool wait_for(const std::vector<Process> &running, const Signals &signals,
              std::vector<pollfd> &wanted) {
  wanted.assign(1, {signals.fd(), POLLIN, 0});
  auto next = Clock::now() + std::chrono::seconds(1);
  for (const Process &p : running) {
    wanted.push_back({p.pipe.fd, POLLIN, 0});
    next = std::min(next, p.end);
  }
  const auto ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(next - Clock::now()).count();
  poll(wanted.data(), wanted.size(), static_cast<int>(std::max<long long>(0, ms + 1)));
  return !signals.came();
}

} // namespace

bool work_through(const Work &work) {
  const Signals signals;
  std::vector<Process> running;
  std::vector<pollfd> wanted;
  std::size_t next = 0;
  bool stopped = false;
  while (!stopped && (next < work.pieces || !running.empty())) {
    while (next < work.pieces && running.size() < work.jobs)
      running.push_back(start(work, next++, signals));
    stopped = !wait_for(running, signals, wanted);
    for (std::size_t k = running.size(); !stopped && k-- > 0;) {
      Process &p = running[k];
      if (Clock::now() >= p.end && !p.late) {
        p.late = true;
        kill_group(p);
      }
      if ((wanted[k + 1].revents == 0 && !p.late) || (drain(p) && !p.late))
        continue;
      finish(work, p);
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }
  for (Process &p : running) {
    kill_group(p);
    waitpid(p.pid, nullptr, 0);
  }
  return !stopped;
}

} // namespace cli
