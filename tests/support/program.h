// Running a program as a shell does, and what came of it.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace umbra {

struct ProgramAnswer {
    int exit_code = -1;  ///< -1 where a signal ended it
    std::string output;  ///< standard output and error together
};

/// `command` is a line for /bin/sh; standard input is empty.
inline ProgramAnswer run_program(const std::string& command) {
    FILE* pipe = popen(("{ " + command + "\n} 2>&1 </dev/null").c_str(), "r");
    ProgramAnswer answer;
    std::array<char, 4096> buffer{};
    for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
        answer.output.append(buffer.data(), n);
    const int status = pclose(pipe);
    answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return answer;
}

}  // namespace umbra
