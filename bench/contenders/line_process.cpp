#include "umbra/bench/contenders/line_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string_view>
#include <thread>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/stopwatch.h"

namespace umbra {
namespace {

constexpr std::size_t kMostLine = 1u << 16, kMostWords = 2048;
constexpr double kSecondsToEnd = 2;
constexpr std::chrono::milliseconds kLook{20};

/// How a program ended.
std::string ending(int status) {
    if (WIFSIGNALED(status))
        return fmt::format("was ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
    return fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

void close_one(int& file) {
    if (file >= 0) close(file);
    file = -1;
}

}  // namespace

LineProcess::LineProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                         const std::filesystem::path& scratch) {
    if (command.empty()) throw MethodError("the command has no words");
    // A socket, since writing to one whose other end is closed need not raise SIGPIPE.
    std::array<int, 2> in{}, out{}, error{}, started{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in.data()) != 0 || pipe2(out.data(), O_CLOEXEC) != 0 ||
        pipe2(error.data(), O_CLOEXEC) != 0 || pipe2(started.data(), O_CLOEXEC) != 0)
        throw MethodError(fmt::format("{}: no pipe to it: {}", command[0], std::strerror(errno)));
    std::vector<char*> words;
    for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    std::string temporary = "TMPDIR=" + scratch.string();
    std::vector<char*> environment;
    for (char** entry = environ; *entry != nullptr; ++entry)
        if (scratch.empty() || !std::string_view(*entry).starts_with("TMPDIR=")) environment.push_back(*entry);
    if (!scratch.empty()) environment.push_back(temporary.data());
    environment.push_back(nullptr);
    const std::string where = folder.string();
    const pid_t parent      = getpid();
    pid_                    = fork();
    if (pid_ == 0) {  // only calls that are safe between fork and exec
        setpgid(0, 0);
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(127);
        dup2(in[1], 0), dup2(out[1], 1), dup2(error[1], 2);
        sigset_t none;
        sigemptyset(&none);
        sigprocmask(SIG_SETMASK, &none, nullptr);
        if (chdir(where.c_str()) == 0) execvpe(words[0], words.data(), environment.data());
        const int why = errno;
        if (write(started[1], &why, sizeof why) < 0) _exit(126);
        _exit(127);
    }
    close(in[1]), close(out[1]), close(error[1]), close(started[1]);
    to_ = in[0], from_ = out[0], errors_ = error[0];
    if (pid_ > 0) setpgid(pid_, pid_);
    int why        = pid_ < 0 ? errno : 0;
    const bool bad = pid_ < 0 || read(started[0], &why, sizeof why) == sizeof why;
    close(started[0]);
    if (bad) {
        end();
        throw MethodError(fmt::format("{}: cannot be started: {}", command[0], std::strerror(why)));
    }
    fcntl(from_, F_SETFL, O_NONBLOCK), fcntl(errors_, F_SETFL, O_NONBLOCK), fcntl(to_, F_SETFL, O_NONBLOCK);
}

LineProcess::~LineProcess() {
    close_one(to_);
    const Stopwatch start;
    while (pid_ > 0 && start.seconds() < kSecondsToEnd) {
        read_some(from_, read_, 0), read_some(errors_, stderr_, 0);  // so that it does not wait for us
        int status = 0;
        if (waitpid(pid_, &status, WNOHANG) == pid_) {
            kill(-pid_, SIGKILL);  // what it started and left
            pid_ = -1;
            break;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    end();
}

void LineProcess::end() {
    if (pid_ > 0) {
        kill(-pid_, SIGKILL), kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    pid_ = -1;
    close_one(to_), close_one(from_), close_one(errors_);
}

void LineProcess::read_some(int& from, std::string& into, std::size_t most) {
    std::array<char, 4096> some{};
    while (from >= 0) {
        const ssize_t n = read(from, some.data(), some.size());
        if (n == 0) close_one(from);
        if (n <= 0) return;
        into.append(some.data(), static_cast<std::size_t>(n));
        if (&into == &stderr_ && stderr_.size() > 2 * kMostWords) stderr_.erase(0, stderr_.size() - kMostWords);
        if (&into == &read_ && read_.size() > most) return;
    }
}

std::string LineProcess::last_words() const {
    std::string words = stderr_.substr(stderr_.size() - std::min(stderr_.size(), kMostWords));
    while (!words.empty() && std::isspace(static_cast<unsigned char>(words.back())) != 0) words.pop_back();
    return words.empty() ? "" : fmt::format(" Its last lines on stderr: {}", words);
}

void LineProcess::fail(const std::string& what) {
    if (errors_ >= 0) read_some(errors_, stderr_, 0);
    end();
    throw MethodError(what + last_words());
}

void LineProcess::tell(const std::string& line) {
    const std::string sent = line + "\n";
    if (is_alive()) static_cast<void>(send(to_, sent.data(), sent.size(), MSG_NOSIGNAL));
}

std::string LineProcess::ask(const std::string& line, double seconds) {
    if (!is_alive()) throw MethodError("the program has ended." + last_words());
    const std::string sent = line + "\n";
    std::size_t written    = 0;
    const Stopwatch start;
    while (true) {
        if (const std::size_t end_of_line = read_.find('\n'); end_of_line != std::string::npos) {
            std::string answer = read_.substr(0, end_of_line);
            read_.erase(0, end_of_line + 1);
            if (!answer.empty() && answer.back() == '\r') answer.pop_back();
            return answer;
        }
        if (read_.size() > kMostLine)
            fail(
                fmt::format("the program wrote {} bytes to stdout without the end of a line, where answers of one line "
                            "are expected.",
                            read_.size()));
        if (from_ < 0) {
            int status = 0;
            for (int k = 0; k < 100 && waitpid(pid_, &status, WNOHANG) != pid_; ++k) {
                std::this_thread::sleep_for(kLook / 2);
                if (k == 99) fail("the program closed its stdout before it answered.");
            }
            read_some(errors_, stderr_, 0);
            kill(-pid_, SIGKILL);
            pid_ = -1;
            fail(fmt::format("the program {} before it answered.", ending(status)));
        }
        if (const WorkLimit* limit = WorkLimit::current()) {
            try {
                limit->check();
            } catch (...) {
                end();
                throw;
            }
        }
        if (start.seconds() > seconds)
            fail(fmt::format("the program did not answer within {:g} s and was ended.", seconds));
        std::array<pollfd, 3> files{{{from_, POLLIN, 0}, {errors_, POLLIN, 0}, {to_, POLLOUT, 0}}};
        if (written == sent.size()) files[2].fd = -1;
        poll(files.data(), files.size(), static_cast<int>(kLook.count()));
        if (files[2].fd >= 0 && files[2].revents != 0) {
            const ssize_t n = send(to_, sent.data() + written, sent.size() - written, MSG_NOSIGNAL);
            if (n > 0) written += static_cast<std::size_t>(n);
            if (n < 0 && errno != EAGAIN && errno != EINTR) written = sent.size();  // it has ended: from_ will say so
        }
        read_some(errors_, stderr_, 0);
        read_some(from_, read_, kMostLine);
    }
}

}  // namespace umbra
