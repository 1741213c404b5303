#include "umbra/bench/cli/terminal.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "umbra/bench/cli/streams.h"

namespace umbra {
namespace {

constexpr const char* kClearLine = "\r\033[K";

std::size_t columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

}  // namespace

Terminal::Terminal(bool quiet) : quiet_(quiet), shows_progress_(!quiet && isatty(STDERR_FILENO) != 0) {}

Terminal::~Terminal() {
    if (shows_progress_) std::fputs(kClearLine, stderr);
}

void Terminal::progress(std::string_view what) const {
    if (!shows_progress_) return;
    std::fputs(kClearLine, stderr);
    write_error(what.substr(0, columns() - 1));
}

void Terminal::warn(std::string_view what) const {
    if (quiet_) return;
    if (shows_progress_) std::fputs(kClearLine, stderr);
    std::string line(what);
    std::replace(line.begin(), line.end(), '\n', ' ');  // one line a warning, whatever names hold
    print_error("warning: {}\n", line);
}

}  // namespace umbra
