// Output that appears all together or not at all.
#pragma once

#include <filesystem>
#include <set>
#include <string_view>

namespace umbra {

/// Files are written and copied as FILE.part and renamed by commit(); a failure before that leaves nothing. Throws
/// InputError naming the file.
class StagedFiles {
public:
    StagedFiles()                              = default;
    StagedFiles(const StagedFiles&)            = delete;
    StagedFiles& operator=(const StagedFiles&) = delete;
    ~StagedFiles();

    void write(const std::filesystem::path& file, std::string_view content);
    void copy(const std::filesystem::path& from,
              const std::filesystem::path& to);  ///< only the first call for a file has an effect
    void commit();

private:
    bool stage(const std::filesystem::path& file);
    std::set<std::filesystem::path> files_;
};

}  // namespace umbra
