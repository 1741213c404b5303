// A folder for files that nobody keeps.
#pragma once

#include <filesystem>

namespace umbra {

/// A folder below the system's for temporary files, which goes with the object. What killed runs left there is removed
/// first.
class ScratchFolder {
public:
    /// Throws InputError where no folder can be made.
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&)            = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace umbra
