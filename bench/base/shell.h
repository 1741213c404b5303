// Words of a command line that people paste into a shell.
#pragma once

#include <string>

namespace umbra {

/// The text as one word of sh: in single quotes. Text with control characters or without valid UTF-8, which a terminal
/// may not hold, is written as $'...', which bash, zsh and ksh read.
[[nodiscard]] std::string shell_quoted(const std::string& text);

}  // namespace umbra
