#include "umbra/bench/base/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>

#include "umbra/core/base/error.h"
#include "umbra/core/base/utf8.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {

/// Names that mean devices on Windows, and those of our own files and folders in an output folder.
bool is_reserved(const std::string& name) {
    static const std::regex reserved(R"((con|prn|aux|nul|com[0-9]|lpt[0-9])(\..*)?|ladders|breaks|)"
                                     R"(index\.html|results\.json|report\.css|(slider|finder|pictures)\.js)",
                                     std::regex::icase);
    return std::regex_match(name, reserved);
}

}  // namespace

std::string folder_name(const std::string& name) {
    constexpr std::size_t longest = 100;
    std::string folder;
    for (std::size_t at = 0; at < name.size();) {
        const std::size_t bytes = utf8_length(name, at);
        const auto c            = static_cast<unsigned char>(name[at]);
        const bool fits         = bytes > 1 || (bytes == 1 && c >= 0x20 && c != 0x7f && !std::strchr("<>:\"/\\|?*", c));
        if (folder.size() + std::max<std::size_t>(bytes, 1) > longest) {
            folder += fmt::format("-{:08x}", std::hash<std::string>{}(name)&0xffffffff);
            break;
        }
        folder += fits ? name.substr(at, bytes) : "_";
        at += std::max<std::size_t>(bytes, 1);
    }
    if (folder.empty() || is_reserved(folder)) folder += '_';
    for (const std::size_t end : {std::size_t{0}, folder.size() - 1})
        if (folder[end] == '.' || folder[end] == ' ') folder[end] = '_';
    return folder;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write_text(const fs::path& file, std::string_view text) {
    errno = 0;
    std::ofstream out(file, std::ios::binary);
    out.write(text.data(), std::streamsize(text.size()));
    out.close();
    if (!out)
        throw InputError(fmt::format("{}: cannot be written{}{}", file.string(), errno != 0 ? ": " : "",
                                     errno != 0 ? std::strerror(errno) : ""));
}

void make_folder(const fs::path& folder) {
    if (folder.empty()) return;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw InputError(fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
}

}  // namespace umbra
