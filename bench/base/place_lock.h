// One run at a time writes to a place, and what killed runs left there is cleared away by the next.
#pragma once

#include <filesystem>
#include <string>

namespace umbra {

/// Hidden names that are ours, and no user's: ".umbra-lock", ".NAME.umbra-new" and the like.
[[nodiscard]] bool is_hidden_name_of_ours(const std::filesystem::path& file);

/// An exclusive lock that the system lifts when the process ends, however it ends. File systems without locks are used
/// without.
class PlaceLock {
public:
    /// Inside a folder, which is made where it is missing, and removed in the end if it is still empty; what killed
    /// runs left in it is removed. Throws InputError where it cannot be written, or where another run holds it.
    [[nodiscard]] static PlaceLock inside(const std::filesystem::path& folder);
    /// Beside a file or folder, whose parent is made where it is missing. Throws InputError likewise.
    [[nodiscard]] static PlaceLock beside(const std::filesystem::path& place);

    PlaceLock(PlaceLock&& other) noexcept;
    PlaceLock(const PlaceLock&)            = delete;
    PlaceLock& operator=(const PlaceLock&) = delete;
    PlaceLock& operator=(PlaceLock&&)      = delete;
    ~PlaceLock();

private:
    PlaceLock(std::filesystem::path file, const std::filesystem::path& place);
    std::filesystem::path file_, made_;  ///< made_: the folder, where this object made it
    int descriptor_ = -1;
};

/// ".NAME.umbra-WHAT" beside a place. Long names are shortened so that two of them stay two.
[[nodiscard]] std::filesystem::path hidden_beside(const std::filesystem::path& place, std::string_view what);

}  // namespace umbra
