#include "umbra/bench/base/scratch_folder.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "umbra/core/base/error.h"

namespace umbra {
namespace fs = std::filesystem;

ScratchFolder::ScratchFolder() {
    const std::string start = "umbra-of-";
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(fs::temp_directory_path(), ignored)) {  // of runs that were killed
        const std::string old = entry.path().filename().string();
        if (!old.starts_with(start)) continue;
        const int owner = std::atoi(old.c_str() + start.size());
        if (owner > 0 && kill(owner, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), ignored);
    }
    std::string name = (fs::temp_directory_path() / fmt::format("{}{}-XXXXXX", start, getpid())).string();
    if (::mkdtemp(name.data()) == nullptr)
        throw InputError(fmt::format("{}: cannot be made: {}", name, std::strerror(errno)));
    path_ = name;
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

}  // namespace umbra
