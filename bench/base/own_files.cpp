#include "umbra/bench/base/own_files.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "umbra/bench/base/place_lock.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::string_view kRecord = "results.json", kPage = "index.html";
constexpr std::array<std::string_view, 2> kEnergyFiles = {"objects.csv", "faces.csv"};  // its record names no files
constexpr std::array<std::string_view, 5> kPageFiles   = {"report.css", "slider.js", "compare.js", "finder.js",
                                                          "pictures.js"};

/// A results.json of ours of any version; discarded where it is none.
json record_in(const fs::path& folder) {
    std::ifstream in(folder / kRecord, std::ios::binary);
    json record    = json::parse(in, nullptr, false);
    const auto has = [&](const char* key) { return record.contains(key); };
    if (!record.is_object() || !has("schema") || !has("version")) return json(json::value_t::discarded);
    return record;
}

bool is_our_page(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string head(4096, '\0');
    in.read(head.data(), std::streamsize(head.size()));
    return head.find(R"(<meta name="generator" content="umbra">)") != std::string::npos;
}

void collect_strings(const json& value, std::set<std::string>& strings) {
    if (value.is_string()) strings.insert(value.get<std::string>());
    if (value.is_structured())
        for (const json& item : value) collect_strings(item, strings);
}

/// The first file below the folder whose name is not among `ours`; empty where there is none.
fs::path first_foreign(const fs::path& folder, const std::set<std::string>& ours) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if ((entry.is_symlink() || !entry.is_directory()) && !is_hidden_name_of_ours(entry.path()) &&
            !ours.contains(entry.path().filename().string()))
            return entry.path().lexically_relative(folder);
    return {};
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& why) {
    throw InputError(fmt::format("{}: {}, expected another folder with -o", folder.string(), why));
}

}  // namespace

void check_replaceable(const fs::path& folder) {
    if (!fs::exists(folder)) return;
    if (!fs::is_directory(folder)) refuse(folder, "is not a folder");
    try {
        std::set<std::string> ours;
        if (const json record = record_in(folder); !record.is_discarded()) {
            collect_strings(record, ours);
            ours.insert({std::string(kRecord), std::string(kPage)});
            ours.insert(kPageFiles.begin(), kPageFiles.end());
            if (record.contains("frames") && record.contains("mean"))
                ours.insert(kEnergyFiles.begin(), kEnergyFiles.end());
        }
        const fs::path foreign = first_foreign(folder, ours);
        if (foreign.empty()) return;
        if (ours.empty()) refuse(folder, "exists, holds no results.json of umbra and is not replaced");
        refuse(folder, fmt::format("holds {}, which umbra did not write, and is not replaced", foreign.string()));
    } catch (const fs::filesystem_error& e) {
        refuse(folder, fmt::format("cannot be read: {}", e.code().message()));
    }
}

bool holds_record_without(const fs::path& folder, std::string_view key) {
    const json record = record_in(folder);
    return !record.is_discarded() && !record.contains(key);
}

void check_writable_beside(const fs::path& folder, const std::vector<std::string>& more) {
    const bool page = fs::exists(folder / kPage), ours = page && is_our_page(folder / kPage);
    const auto refuse_file = [&](std::string_view name) {
        refuse(folder, fmt::format("holds {}, which umbra did not write", name));
    };
    if (page && !ours) refuse_file(kPage);
    if (fs::exists(folder / kRecord) && record_in(folder).is_discarded()) refuse_file(kRecord);
    for (const std::string_view name : kPageFiles)
        if (!ours && fs::exists(folder / name)) refuse_file(name);
    std::set<std::string> named;
    collect_strings(record_in(folder), named);
    for (const std::string& name : more)
        if (fs::exists(folder / name) && !named.contains(name)) refuse_file(name);
}

}  // namespace umbra
