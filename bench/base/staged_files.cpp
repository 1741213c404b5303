#include "umbra/bench/base/staged_files.h"

#include <fmt/format.h>

#include "umbra/bench/base/files.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {
fs::path beside(const fs::path& file) { return file.parent_path() / (".umbra-part." + file.filename().string()); }
}  // namespace

StagedFiles::~StagedFiles() {
    std::error_code ignored;
    for (const fs::path& file : files_) fs::remove(beside(file), ignored);
}

/// False where it is staged already.
bool StagedFiles::stage(const fs::path& file) {
    make_folder(file.parent_path());
    return files_.insert(file).second;
}

void StagedFiles::write(const fs::path& file, std::string_view content) {
    stage(file);
    write_text(beside(file), content);
}

void StagedFiles::copy(const fs::path& from, const fs::path& to) {
    if (!stage(to)) return;
    std::error_code error;
    fs::copy_file(from, beside(to), fs::copy_options::overwrite_existing, error);
    if (error)
        throw InputError(fmt::format("{}: cannot be copied from {}: {}", to.string(), from.string(), error.message()));
}

fs::path StagedFiles::place(const fs::path& file) {
    stage(file);
    return beside(file);
}

void StagedFiles::remove(const fs::path& file) { removed_.insert(file); }

void StagedFiles::commit() {
    std::error_code error;
    for (const fs::path& file : files_) {
        fs::rename(beside(file), file, error);
        if (error) throw InputError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
    }
    for (const fs::path& file : removed_) {
        fs::remove(file, error);
        if (error) throw InputError(fmt::format("{}: cannot be removed: {}", file.string(), error.message()));
    }
    files_.clear();
    removed_.clear();
}

}  // namespace umbra
