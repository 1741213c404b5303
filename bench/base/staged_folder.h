// An output folder that appears whole or not at all.
#pragma once

#include <filesystem>

#include "umbra/bench/base/place_lock.h"

namespace umbra {

/// A hidden folder beside `to`, which takes the place of `to` with commit() and is removed where that is not called. An
/// existing `to` stays as it is until commit(), and is replaced only if everything in it is ours (own_files.h). What a
/// killed run left behind is removed first; a result that it was about to replace is restored. While one object exists,
/// a second one for the same place is refused, also in another process. Throws InputError.
class StagedFolder {
public:
    explicit StagedFolder(const std::filesystem::path& to);
    ~StagedFolder();
    StagedFolder(const StagedFolder&)            = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    void commit();

private:
    std::filesystem::path to_, folder_;
    PlaceLock lock_;
};

}  // namespace umbra
