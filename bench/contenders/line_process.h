// A program that is asked and answers in lines: started, spoken to, and ended with all that it started itself.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace umbra {

/// One caller at a time. Its stdin and stdout are ours, what it writes to stderr is kept in part. Own code: of the
/// libraries that start programs none bounds what is read and ends the whole group.
class LineProcess {
public:
    /// Starts `command` (its first word is looked up in PATH) in `folder`, as the head of a process group of its own, with
    /// `scratch`, if given, as its TMPDIR: what is ended cannot tidy up. Throws MethodError where it cannot be started.
    LineProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                const std::filesystem::path& scratch = {});
    /// Closes its stdin, waits a moment for it to end, and ends what is left of its group.
    ~LineProcess();
    LineProcess(const LineProcess&)            = delete;
    LineProcess& operator=(const LineProcess&) = delete;

    /// Writes a line and returns the next one that it writes, without its end. Throws MethodError where the program has
    /// ended, where it writes more than 64 KiB without ending the line, and where it takes longer than `seconds`; and
    /// what WorkLimit::current() throws. The program is then ended. Each message has the last lines of its stderr.
    [[nodiscard]] std::string ask(const std::string& line, double seconds);

    /// Writes a line for which no answer is expected; what does not fit at once is lost.
    void tell(const std::string& line);

    [[nodiscard]] bool is_alive() const { return pid_ > 0; }
    /// Ends the program and its group at once, and throws MethodError: `what`, and the last lines of its stderr.
    [[noreturn]] void fail(const std::string& what);

private:
    void end();
    [[nodiscard]] std::string last_words() const;  ///< of its stderr, at most 2 KiB; or nothing
    void read_some(int& from, std::string& into, std::size_t most);

    int pid_ = -1, to_ = -1, from_ = -1, errors_ = -1;
    std::string read_, stderr_;
};

}  // namespace umbra
