// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/screen.h"

#include <array>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <langinfo.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/stop.h"

#define NCURSES_NOMACROS
#include <curses.h>
#include <term.h>
#undef columns // which term.h makes a macro

namespace cli {

namespace {

/// Of what others print; more is nobody's interest when the terminal is given back.
constexpr off_t kMostRemarks = 64 << 10;

/// Standard error in a file without a name, as long as it would be written across the picture.
class HeldRemarks {
public:
  HeldRemarks() {
    if (isatty(STDERR_FILENO) == 0)
      return;
    file_ = memfd_create("remarks", MFD_CLOEXEC);
    terminal_ = dup(STDERR_FILENO);
    if (file_ >= 0 && terminal_ >= 0)
      dup2(file_, STDERR_FILENO);
  }
  ~HeldRemarks() {
    if (terminal_ >= 0)
      dup2(terminal_, STDERR_FILENO);
    const std::string text = tail(kMostRemarks);
    if (terminal_ >= 0)
      (void)!write(terminal_, text.data(), text.size());
    close(file_);
    close(terminal_);
  }
  HeldRemarks(const HeldRemarks &) = delete;
  HeldRemarks &operator=(const HeldRemarks &) = delete;

  std::string last_line() const {
    std::string text = tail(256);
    while (!text.empty() && text.back() == '\n')
      text.pop_back();
    return text.substr(text.rfind('\n') + 1);
  }

  /// A device that is away for days has much to say.
  void bound() {
    struct stat info {};
    if (file_ >= 0 && fstat(file_, &info) == 0 && info.st_size > 4 * kMostRemarks &&
        ftruncate(file_, 0) == 0)
      lseek(file_, 0, SEEK_SET);
  }

private:
  std::string tail(off_t most) const {
    struct stat info {};
    if (file_ < 0 || fstat(file_, &info) != 0)
      return {};
    const off_t size = info.st_size < most ? info.st_size : most;
    std::string text(static_cast<std::size_t>(size), '\0');
    const ssize_t got = pread(file_, text.data(), text.size(), info.st_size - size);
    text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return text;
  }

  int file_ = -1, terminal_ = -1;
};

/// Of so many characters in UTF-8, each a column wide; what is not drawn in a column is not used.
std::size_t bytes_of(std::string_view text, int characters) {
  std::size_t at = 0;
  for (; at < text.size(); ++at)
    if ((static_cast<unsigned char>(text[at]) & 0xc0) != 0x80 && characters-- == 0)
      break;
  return at;
}

/// What gives the terminal back: ncurses' own endwin() may not be called by a signal handler.
std::string giving_back() {
  static std::string bytes; // tputs() calls a function without an argument of ours
  bytes.clear();
  for (const char *name : {"sgr0", "op", "rmkx", "cnorm", "rmcup"}) {
    const char *capability = tigetstr(name);
    if (capability && capability != reinterpret_cast<const char *>(-1))
      tputs(capability, 1, [](int c) {
        bytes.push_back(static_cast<char>(c));
        return c;
      });
  }
  return bytes;
}

bool wants_colours() {
  const char *no = std::getenv("NO_COLOR");
  return no == nullptr || *no == '\0';
}

} // namespace

struct Screen::Terminal {
  HeldRemarks remarks;
  FILE *keys = nullptr; ///< the terminal, where standard input is something else
  SCREEN *screen = nullptr;
  bool colours = false;
  Farewell farewell;

  ~Terminal() {
    if (screen) {
      endwin();
      set_farewell(nullptr);
      delscreen(screen);
    }
    if (keys)
      fclose(keys);
  }
};

bool Screen::is_there() {
  const char *type = std::getenv("TERM");
  return isatty(STDOUT_FILENO) != 0 && type != nullptr && *type != '\0' &&
         std::string_view(type) != "dumb";
}

std::unique_ptr<Screen> Screen::open() {
  if (!is_there())
    return nullptr;
  std::setlocale(LC_CTYPE, ""); // the characters alone: numbers keep their point
  auto terminal = std::make_unique<Terminal>();
  if (isatty(STDIN_FILENO) == 0)
    terminal->keys = std::fopen("/dev/tty", "re");
  Farewell &farewell = terminal->farewell;
  farewell.screen = STDOUT_FILENO;
  farewell.keys = terminal->keys ? fileno(terminal->keys) : STDIN_FILENO;
  tcgetattr(farewell.keys, &farewell.modes);
  terminal->screen = newterm(nullptr, stdout, terminal->keys ? terminal->keys : stdin);
  if (!terminal->screen)
    return nullptr;
  farewell.bytes = giving_back();
  set_farewell(&farewell);
  return std::unique_ptr<Screen>(new Screen(std::move(terminal)));
}

Screen::Screen(std::unique_ptr<Terminal> terminal)
    : terminal_(std::move(terminal)),
      unicode_(std::strcmp(nl_langinfo(CODESET), "UTF-8") == 0) {
  cbreak();
  noecho();
  curs_set(0);
  nodelay(stdscr, TRUE);
  keypad(stdscr, TRUE);
  set_escdelay(25);
  if (wants_colours() && has_colors()) {
    terminal_->colours = true;
    start_color();
    use_default_colors();
    init_pair(1, COLOR_GREEN, -1);
    init_pair(2, COLOR_RED, -1);
    init_pair(3, COLOR_CYAN, -1);
  }
}

Screen::~Screen() = default;

int Screen::rows() const {
  return getmaxy(stdscr);
}
int Screen::columns() const {
  return getmaxx(stdscr);
}

void Screen::clear() {
  werase(stdscr);
}

void Screen::put(int row, int column, std::string_view text, Style style) {
  if (row < 0 || row >= rows() || column < 0 || column >= columns())
    return;
  const bool colours = terminal_->colours;
  const auto pair = [colours](int number) {
    return colours ? static_cast<attr_t>(COLOR_PAIR(number)) : attr_t{A_NORMAL};
  };
  const std::array<attr_t, 6> attributes = {
      attr_t{A_NORMAL},  attr_t{A_DIM},     attr_t{A_BOLD},
      pair(1),           pair(2) | A_BOLD,  pair(3) | A_BOLD};
  wattrset(stdscr, static_cast<int>(attributes[static_cast<std::size_t>(style)]));
  mvwaddnstr(stdscr, row, column, text.data(),
             static_cast<int>(bytes_of(text, columns() - column)));
  wattrset(stdscr, A_NORMAL);
}

void Screen::show() {
  terminal_->remarks.bound();
  wrefresh(stdscr);
}

int Screen::key() {
  const int key = wgetch(stdscr);
  if (key == KEY_RESIZE) {
    clearok(stdscr, TRUE);
    return kResized;
  }
  return key == ERR ? kNoKey : key;
}

std::string Screen::last_remark() const {
  return terminal_->remarks.last_line();
}

} // namespace cli
