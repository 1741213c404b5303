// One line on the terminal that shows what is being done, and warnings.
#pragma once

#include <string>
#include <string_view>

namespace umbra {

/// Writes to standard error: progress only where that is a terminal. Not to be copied: its end clears the line.
class Terminal {
public:
    explicit Terminal(bool quiet);
    ~Terminal();
    Terminal(const Terminal&)            = delete;
    Terminal& operator=(const Terminal&) = delete;

    /// Replaces the progress line, cut to the terminal's width. Nothing where quiet.
    void progress(std::string_view what) const;
    /// Prints "warning: WHAT" on a line of its own. Nothing where quiet.
    void warn(std::string_view what) const;

private:
    bool quiet_, shows_progress_;
};

}  // namespace umbra
