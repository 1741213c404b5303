// An output folder that appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace umbra {

/// A folder beside the one to be, which takes its place on commit() and is gone where that is not called. What stands
/// there already is replaced only if it is empty or holds a results.json, and stays whole until then. Throws
/// InputError.
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

/// Writes a file of text as it is. Throws InputError naming it.
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace umbra
