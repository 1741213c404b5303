#include "umbra/bench/cli/streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

[[noreturn]] void fail() {
    const int reason = errno;
    if (reason == EPIPE) throw OutputClosed();
    throw InputError(fmt::format("standard output: cannot be written: {}", std::strerror(reason)));
}

}  // namespace

void prepare_streams() {
    // The lowest free descriptor is taken, which is the closed one. Writing to a descriptor for reading fails.
    for (int descriptor = 0; descriptor <= 2; ++descriptor)
        if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) static_cast<void>(::open("/dev/null", O_RDONLY));
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

void write_out(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail();
}

void flush_out() {
    if (std::fflush(stdout) != 0) fail();
    if (!std::cout.flush()) fail();
}

void end_like_closed_pipe() {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
    std::_Exit(128 + SIGPIPE);
}

std::string without_controls(std::string text) {
    for (char& c : text)
        if ((static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7f) c = '?';
    return text;
}

void write_error(std::string_view text) {
    const std::string shown = without_controls(std::string(text));
    std::fwrite(shown.data(), 1, shown.size(), stderr);
}

}  // namespace umbra
