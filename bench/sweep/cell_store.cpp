#include "umbra/bench/sweep/cell_store.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>

#include "umbra/bench/base/files.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kHalf = ".half-";  // behind it the number of the process that writes

void move_into_place(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) throw InputError(fmt::format("{}: {}, expected a place to write to", to.string(), error.message()));
}

}  // namespace

CellStore::CellStore(fs::path folder) : folder_(std::move(folder)) {
    make_folder(folder_);
    const auto old = fs::file_time_type::clock::now() - std::chrono::hours(24);
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_, error)) {
        std::error_code ignored;
        if (entry.path().filename().string().find(kHalf) != std::string::npos && entry.last_write_time(ignored) < old &&
            !ignored)
            fs::remove(entry.path(), ignored);
    }
}

Field CellStore::entry(const std::string& key) const {
    const fs::path file = folder_ / (key + ".json");
    if (!fs::exists(file)) return {};
    try {
        const Field cell = parse_json(bytes_of(file), file.string());
        return cell.is_object() && cell["key"].text() == key ? cell : Field();
    } catch (const InputError&) {  // cut off
        return {};
    }
}

void CellStore::write(const std::string& key, const std::string& text) const {
    const fs::path file = folder_ / (key + ".json");
    const fs::path half = file.string() + fmt::format("{}{}", kHalf, getpid());
    write_text(half, text);
    move_into_place(half, file);
}

void CellStore::add_all(const CellStore& other) const {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(other.folder_, error)) {
        const fs::path name = entry.path().filename();
        if (name.string().find(kHalf) != std::string::npos || fs::exists(folder_ / name)) continue;
        const fs::path half = folder_ / (name.string() + fmt::format("{}{}", kHalf, getpid()));
        fs::copy_file(entry.path(), half, fs::copy_options::overwrite_existing, error);
        if (error) throw InputError(fmt::format("{}: {}, expected a cell", entry.path().string(), error.message()));
        move_into_place(half, folder_ / name);
    }
    if (error)
        throw InputError(fmt::format("{}: {}, expected cells of a sweep", other.folder_.string(), error.message()));
}

}  // namespace umbra
