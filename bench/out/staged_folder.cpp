#include "umbra/bench/out/staged_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include "umbra/bench/out/files.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

StagedFolder::StagedFolder(const fs::path& to) : to_(fs::absolute(to).lexically_normal()) {
    if (to_.filename().empty()) to_ = to_.parent_path();  // written with a slash at its end
    if (fs::exists(to_) && !fs::exists(to_ / "results.json") && !(fs::is_directory(to_) && fs::is_empty(to_)))
        throw InputError(fmt::format(
            "{}: exists, holds no results.json and is not replaced, expected another folder with -o", to.string()));
    folder_ = to_.parent_path() / fmt::format(".{}.{}", to_.filename().string(), ::getpid());
    std::error_code ignored;  // usually there is none: an interrupted process of the same id left it
    fs::remove_all(folder_, ignored);
    make_folder(folder_);
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;  // after commit() there is nothing to remove
    fs::remove_all(folder_, ignored);
}

void StagedFolder::commit() {
    const fs::path old = folder_.string() + ".old";
    if (fs::exists(to_)) fs::rename(to_, old);
    fs::rename(folder_, to_);
    fs::remove_all(old);
}

}  // namespace umbra
