// Output that appears all together or not at all.
#pragma once

#include <filesystem>
#include <set>
#include <string_view>

namespace umbra {

/// Files are written and copied under hidden names beside their places, and renamed by commit(); a failure before that
/// leaves nothing. The names are fixed, so that killed runs leave at most one of each; a PlaceLock keeps two runs
/// apart. Throws InputError naming the file.
class StagedFiles {
public:
    StagedFiles()                              = default;
    StagedFiles(const StagedFiles&)            = delete;
    StagedFiles& operator=(const StagedFiles&) = delete;
    ~StagedFiles();

    void write(const std::filesystem::path& file, std::string_view content);
    void copy(const std::filesystem::path& from,
              const std::filesystem::path& to);  ///< only the first call for a file has an effect
    /// Where the caller writes the file itself; it has the same ending.
    [[nodiscard]] std::filesystem::path place(const std::filesystem::path& file);
    void remove(const std::filesystem::path& file);  ///< with commit(), if it is there
    void commit();

private:
    bool stage(const std::filesystem::path& file);
    std::set<std::filesystem::path> files_, removed_;
};

}  // namespace umbra
