#include "umbra/bench/base/place_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <system_error>
#include <utility>
#include <vector>

#include "umbra/bench/base/files.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMark = ".umbra-";

constexpr std::string_view kPart = ".umbra-part.", kNew = ".umbra-new", kLock = ".umbra-lock";

/// Opens and locks a file that may be missing; -1 where it is locked already. Throws std::system_error.
int open_locked(const fs::path& file) {
    while (true) {
        const int descriptor = open(file.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0) throw std::system_error(errno, std::generic_category());
        if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            close(descriptor);
            return -1;
        }
        struct stat of_descriptor {
        }, of_name{};  // its last holder may have removed the file
        if (fstat(descriptor, &of_descriptor) == 0 && stat(file.c_str(), &of_name) == 0 &&
            of_descriptor.st_ino == of_name.st_ino)
            return descriptor;
        close(descriptor);
    }
}

/// Removes `what` and the lock file, unless a run holds that lock.
void remove_unless_locked(const fs::path& what, const fs::path& lock) {
    try {
        const int descriptor = open_locked(lock);
        if (descriptor < 0) return;
        std::error_code ignored;
        fs::remove_all(what, ignored);
        fs::remove(lock, ignored);
        close(descriptor);
    } catch (const std::system_error&) {  // not ours to remove
    }
}

/// What killed runs left in a folder and one level below.
void sweep(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    fs::recursive_directory_iterator all(folder, fs::directory_options::skip_permission_denied, error);
    for (; !error && all != fs::recursive_directory_iterator(); all.increment(error)) {
        if (all.depth() > 0 || all->path().filename().string().starts_with('.')) all.disable_recursion_pending();
        if (is_hidden_name_of_ours(all->path())) found.push_back(all->path());
    }
    for (const fs::path& path : found) {
        const std::string name = path.filename().string();
        if (name.starts_with(kPart)) remove_unless_locked(path, path);
        if (name.ends_with(kNew))
            remove_unless_locked(path, path.parent_path() / (name.substr(0, name.size() - kNew.size()) += kLock));
        if (name.ends_with(kLock) && name != kLock) remove_unless_locked(path, path);
    }
}

}  // namespace

bool is_hidden_name_of_ours(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.starts_with('.') && name.find(kMark) != std::string::npos;
}

fs::path hidden_beside(const fs::path& place, std::string_view what) {
    constexpr std::size_t longest = 180;  // of a name; a file system allows 255 bytes, some of them are ours
    std::string name              = place.filename().string();
    if (name.size() > longest)
        name = fmt::format("{}-{:016x}", name.substr(0, longest - 17), std::hash<std::string>{}(name));
    return place.parent_path() / fmt::format(".{}{}{}", name, kMark, what);
}

PlaceLock PlaceLock::inside(const fs::path& folder) {
    const bool is_new = !fs::exists(folder);
    make_folder(folder);
    PlaceLock lock(folder / kLock, folder);
    if (is_new) lock.made_ = folder;
    sweep(folder);
    return lock;
}

PlaceLock PlaceLock::beside(const fs::path& place) {
    make_folder(place.parent_path());
    return {hidden_beside(place, "lock"), place};
}

PlaceLock::PlaceLock(fs::path file, const fs::path& place) : file_(std::move(file)) {
    try {
        descriptor_ = open_locked(file_);
    } catch (const std::system_error& e) {
        throw InputError(fmt::format("{}: cannot be written: {}", place.string(), e.code().message()));
    }
    if (descriptor_ < 0)
        throw InputError(
            fmt::format("{}: another run of umbra is writing there, expected to wait for it or another output with -o",
                        place.string()));
}

PlaceLock::PlaceLock(PlaceLock&& other) noexcept
    : file_(std::move(other.file_)), made_(std::move(other.made_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

PlaceLock::~PlaceLock() {
    if (descriptor_ < 0) return;
    std::error_code ignored;
    fs::remove(file_, ignored);                      // before the lock ends: the next holder makes its own
    if (!made_.empty()) fs::remove(made_, ignored);  // only where it is empty
    close(descriptor_);
}

}  // namespace umbra
