#include "umbra/bench/gate/diff_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/base/shell.h"
#include "umbra/bench/gate/diff_record.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {

constexpr std::array kEndings = {".exr",  ".png", ".jpg", ".jpeg", ".hdr", ".pfm", ".tif",
                                 ".tiff", ".bmp", ".tga", ".ppm",  ".pgm", ".webp"};

std::set<fs::path> images_in(const fs::path& folder) {
    std::set<fs::path> names;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (is_hidden_name_of_ours(entry->path())) {  // of a run that was killed, or still goes on
            entry.disable_recursion_pending();
            continue;
        }
        std::string ending = entry->path().extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        if (std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end() && entry->is_regular_file())
            names.insert(entry->path().lexically_relative(folder));
    }
    if (error) throw InputError(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
    return names;
}

DiffResult missing(const fs::path& a, const fs::path& b, const fs::path& name, const std::string& where) {
    DiffResult result;
    result.name    = name.string();
    result.verdict = Verdict::differs;
    result.a       = a.string();
    result.b       = b.string();
    result.reasons = {fmt::format("missing in {}", where)};
    result.accept  = is_there(b) ? accept_by_copying(a, b) : "rm -- " + shell_quoted(a.string());
    return result;
}

DiffResult pair_of_folders(const fs::path& a, const fs::path& b, const fs::path& name, const DiffOptions& options) {
    if (!is_there(a / name)) return missing(a / name, b / name, name, a.string());
    if (!is_there(b / name)) return missing(a / name, b / name, name, b.string());
    DiffOptions of = options;
    of.name        = name.string();
    if (!options.map.empty()) of.map = (options.map / name) += ".png";
    if (!options.pictures.empty()) of.pictures = options.pictures / name;
    for (const fs::path& file : {of.map, of.pictures})
        if (!file.empty()) make_folder(file.parent_path());
    DiffResult result = diff(a / name, b / name, of);
    if (result.verdict == Verdict::same && !of.map.empty()) {  // an older map would show what is gone
        std::error_code ignored;
        fs::remove(of.map, ignored);
    }
    return result;
}

}  // namespace

Verdict DiffSet::worst() const {
    Verdict worst = Verdict::same;
    for (const DiffResult& image : images) worst = std::max(worst, image.verdict);
    return worst;
}

std::size_t DiffSet::count(Verdict verdict) const {
    return std::size_t(
        std::count_if(images.begin(), images.end(), [&](const DiffResult& image) { return image.verdict == verdict; }));
}

DiffSet diff_set(const fs::path& a, const fs::path& b, const DiffOptions& options,
                 const std::function<void(const std::string&)>& progress) {
    DiffSet set{a.string(), b.string(), is_folder(a) || (!is_there(a) && is_folder(b)), {}};
    if (is_there(a) && is_there(b) && is_folder(b) != set.folders)
        throw UsageError(fmt::format("{} is a folder and {} is not, expected two files or two folders",
                                     set.folders ? set.a : set.b, set.folders ? set.b : set.a));
    if (!set.folders) {
        DiffOptions of = options;
        if (!options.pictures.empty()) {
            make_folder(options.pictures);
            of.pictures = options.pictures / a.filename();
        }
        set.images.push_back(diff(a, b, of));
        return set;
    }
    if (!is_there(b))
        throw InputError(fmt::format("{}: no such folder, expected what is held against {}", set.b, set.a));
    std::set<fs::path> names = images_in(b);
    if (is_there(a)) names.merge(images_in(a));
    if (names.empty()) throw InputError(fmt::format("{}: holds no images, nor does {}", set.a, set.b));
    for (const fs::path& name : names) {
        if (progress) progress(name.string());
        set.images.push_back(pair_of_folders(a, b, name, options));
    }
    return set;
}

std::string diff_set_text(const DiffSet& set) {
    std::string accept;
    for (const DiffResult& image : set.images)
        if (!image.accept.empty()) accept += image.accept + "\n";
    if (!accept.empty()) accept = "to accept:\n" + accept;
    if (!set.folders) return diff_text(set.images.at(0)) + accept;
    std::string text;
    for (const DiffResult& image : set.images) text += diff_line(image) + "\n";
    text += fmt::format("{} images", set.images.size());
    char separator = ':';
    for (const Verdict v : kVerdicts) {
        if (set.count(v) == 0) continue;
        text += fmt::format("{} {} {}", separator, set.count(v), to_string(v));
        separator = ',';
    }
    return text + "\n" + accept;
}

nlohmann::json diff_set_json(const DiffSet& set) {
    if (!set.folders) return diff_json(set.images.at(0));
    nlohmann::json json{
        {"verdict", to_string(set.worst())},  {"exit_code", int(set.worst())},    {"a", set.a}, {"b", set.b},
        {"counts", nlohmann::json::object()}, {"images", nlohmann::json::array()}};
    for (const Verdict v : kVerdicts) json["counts"][std::string(to_string(v))] = set.count(v);
    for (const DiffResult& image : set.images) json["images"].push_back(diff_json(image));
    return json;
}

std::string diff_set_junit(const DiffSet& set) {
    std::vector<JunitCase> cases;
    for (const DiffResult& image : set.images) {
        JunitCase& one = cases.emplace_back(JunitCase{.classname = "umbra.diff", .name = image.name});
        if (image.verdict <= Verdict::close) continue;
        one.problem = image.verdict == Verdict::unreadable ? "error" : "failure";
        one.type = to_string(image.verdict), one.message = diff_line(image), one.text = diff_text(image);
    }
    return junit_text("umbra diff", cases);
}

}  // namespace umbra
