#include "umbra/bench/base/staged_folder.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <cstdio>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/own_files.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {

/// The place itself, behind symbolic links and without a slash at the end.
fs::path resolved(const fs::path& to) {
    fs::path place = fs::weakly_canonical(fs::absolute(to));
    return place.filename().empty() ? place.parent_path() : place;
}

void remove_all_quietly(const fs::path& path) {
    std::error_code ignored;
    fs::remove_all(path, ignored);
}

/// Swaps two folders in one step; false where the file system cannot.
bool exchanged(const fs::path& a, const fs::path& b) {
    return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& to)
    : to_(resolved(to)), folder_(hidden_beside(to_, "new")), lock_(PlaceLock::beside(to_)) {
    const fs::path old = hidden_beside(to_, "old");
    std::error_code ignored;
    if (fs::exists(old) && !fs::exists(to_)) fs::rename(old, to_, ignored);
    remove_all_quietly(old);
    remove_all_quietly(folder_);
    check_replaceable(to_);
    make_folder(folder_);
}

StagedFolder::~StagedFolder() { remove_all_quietly(folder_); }  // after commit(): the result that was replaced

void StagedFolder::commit() {
    try {
        check_replaceable(to_);  // somebody may have put something there
        if (fs::exists(to_) && !exchanged(folder_, to_)) {
            const fs::path old = hidden_beside(to_, "old");
            fs::rename(to_, old);
            fs::rename(folder_, to_);
            remove_all_quietly(old);
        } else if (!fs::exists(to_)) {
            fs::rename(folder_, to_);
        }
    } catch (const fs::filesystem_error& e) {
        throw InputError(fmt::format("{}: cannot be replaced: {}", to_.string(), e.code().message()));
    }
}

}  // namespace umbra
