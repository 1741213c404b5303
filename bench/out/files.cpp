#include "umbra/bench/out/files.h"

#include <fmt/format.h>

#include <fstream>

#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

void write_text(const fs::path& file, std::string_view text) {
    std::ofstream out(file, std::ios::binary);
    out.write(text.data(), std::streamsize(text.size()));
    out.close();
    if (!out) throw InputError(fmt::format("{}: cannot be written", file.string()));
}

void make_folder(const fs::path& folder) {
    if (folder.empty()) return;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw InputError(fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
}

}  // namespace umbra
