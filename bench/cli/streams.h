// Standard output and standard error as they may be: closed, full, or with nobody at the other end.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace umbra {

/// Whoever read standard output is gone: no error, but there is no more to do.
class OutputClosed : public std::runtime_error {
public:
    OutputClosed() : std::runtime_error("standard output: its reader has gone") {}
};

/// Before anything is opened: descriptors 0 to 2 are occupied, so that no file of ours becomes standard output, and
/// what cannot be written is an error to handle instead of a signal.
void prepare_streams();

/// Writes to standard output. Throws InputError where that fails, OutputClosed where it is a pipe without a reader.
void write_out(std::string_view text);
/// Writes what is buffered. Throws like write_out.
void flush_out();
/// Ends the process as a closed pipe does by default.
[[noreturn]] void end_like_closed_pipe();

template <class... Parts>
void print_out(fmt::format_string<Parts...> text, Parts&&... parts) {
    write_out(fmt::format(text, std::forward<Parts>(parts)...));
}

/// Writes to standard error. What cannot be written there is lost: there is nobody to report it to. Control characters,
/// which names in files may hold, are replaced, so that they cannot drive a terminal.
void write_error(std::string_view text);

template <class... Parts>
void print_error(fmt::format_string<Parts...> text, Parts&&... parts) {
    write_error(fmt::format(text, std::forward<Parts>(parts)...));
}

/// Text with each control character but newline and tab replaced by "?".
[[nodiscard]] std::string without_controls(std::string text);

}  // namespace umbra
