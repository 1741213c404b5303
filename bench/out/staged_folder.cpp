#include "umbra/bench/out/staged_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

StagedFolder::StagedFolder(const fs::path& to) : to_(fs::absolute(to).lexically_normal()) {
    if (to_.filename().empty()) to_ = to_.parent_path();  // written with a slash at its end
    if (fs::exists(to_) && !fs::exists(to_ / "results.json") && !(fs::is_directory(to_) && fs::is_empty(to_)))
        throw InputError(fmt::format(
            "{}: exists and holds no results.json, so it is not replaced (name another folder with -o)", to.string()));
    std::error_code error;
    fs::create_directories(to_.parent_path(), error);
    folder_ = to_.parent_path() / fmt::format(".{}.{}", to_.filename().string(), ::getpid());
    fs::remove_all(folder_, error);
    fs::create_directory(folder_, error);
    if (error) throw InputError(fmt::format("{}: cannot be made: {}", to.string(), error.message()));
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

void write_text(const fs::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw InputError(fmt::format("{}: cannot write", file.string()));
}

}  // namespace umbra
