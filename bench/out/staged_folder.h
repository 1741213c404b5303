// An output folder that appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace umbra {

/// A temporary folder beside `to`, renamed to `to` by commit() and removed where that is not called. An existing `to`
/// is replaced only if it is empty or holds a results.json, and stays as it is until commit(). Throws InputError.
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
};

}  // namespace umbra
