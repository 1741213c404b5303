#include "umbra/bench/report/course/apart.h"

#include <fmt/format.h>

#include "umbra/bench/contenders/line_process.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using Words  = std::vector<std::string>;

void add(Words& to, const Words& more) { to.insert(to.end(), more.begin(), more.end()); }

/// What a program sees wherever it is started.
Words bwrap(bool network) {
    Words words{"bwrap"};
    for (const char* folder : {"/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc", "/opt", "/nix"})
        add(words, {"--ro-bind-try", folder, folder});
    add(words, {"--dev", "/dev", "--proc", "/proc", "--tmpfs", "/tmp", "--unshare-pid", "--unshare-ipc",
                "--die-with-parent", "--setenv", "HOME", "/tmp"});
    if (!network) words.emplace_back("--unshare-net");
    return words;
}

}  // namespace

bool can_keep_apart() {
    try {
        Words words = bwrap(false);
        add(words, {"--", "echo", "apart"});
        return LineProcess(words, "/").ask("", 10) == "apart";
    } catch (const MethodError&) {
        return false;
    }
}

Words apart_command(const Words& command, const fs::path& folder, const LimitsRecord& limits, bool protect) {
    Words words{"prlimit", "--core=0"};
    if (limits.memory_mib > 0)
        words.push_back(fmt::format("--as={}", static_cast<std::uint64_t>(limits.memory_mib * (1 << 20))));
    words.emplace_back("--");
    if (protect) {
        add(words, bwrap(limits.network));
        add(words, {"--ro-bind", folder.string(), folder.string(), "--bind", "{run}", "{run}", "--chdir",
                    folder.string(), "--"});
    }
    add(words, command);
    return words;
}

ApartRecord apart_record(const LimitsRecord& limits, bool protect) {
    return {.by         = protect ? "bwrap" : "nothing",
            .network    = limits.network || !protect,
            .memory_mib = limits.memory_mib > 0 ? limits.memory_mib : kUnknown,
            .answer_s   = limits.answer_s,
            .scene_s    = limits.scene_s};
}

}  // namespace umbra
