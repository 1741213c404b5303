#include "umbra/bench/gate/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/scratch_folder.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRecord = "results.json";
constexpr const char* kLinear = "reference.rgb.exr";

/// Hard lights and terminators, a penumbra with noise, a bracket and a sample of judged points, undefined points.
struct Compared {
    std::string_view scene;
    std::vector<std::string> methods;
    std::optional<std::uint64_t> points;  ///< judged
};
const std::array kCompared = {
    Compared{"self_shadow", {"shadow_zbuffer:resolution=64,bias=manual,constant=1", "planar_projection"}, {}},
    Compared{"umbra_penumbra", {"ray_traced:samples=4", "shadow_volumes"}, {}},
    Compared{"eclipse", {"ray_traced:samples=4", "planar_projection:light_samples=8"}, 500},
};

/// What is the same whenever and wherever it is measured.
Json lasting(Json record) {
    for (const char* key : {"command", "machine", "times", "turns", "version"}) record.erase(key);
    record["scene"].erase("source");
    record["reference"].erase("times");
    for (Json& method : record["methods"])
        for (const char* key : {"times", "light_times", "memory_bytes", "points_bytes", "device_bytes"})
            method.erase(key);
    return record;
}

/// R, G, B of a file.
Image linear_colours(const fs::path& file) {
    const Image all = read_image(file).image;
    Image colours(all.width, all.height, {"R", "G", "B"});
    const auto from = colour_channels(all);
    for (std::size_t i = 0; i < all.pixels(); ++i)
        for (std::size_t c = 0; c < 3; ++c) colours.at(i, c) = all.at(i, from[c]);
    return colours;
}

/// The files of a comparison as they are kept, in `folder`.
void run_comparison(const fs::path& scene, const Compared& compared, const fs::path& folder) {
    CompareOptions options;
    options.methods       = compared.methods;
    options.points        = compared.points;
    options.size          = kGoldenSize;
    options.out           = folder;
    options.repeats       = kOnce;
    const Results results = compare_scene(scene, options);
    const fs::path of     = folder / results.scene.name;
    write_image(of / kLinear, linear_colours(of / "reference.exr"));
    write_text(of / kRecord, lasting(to_record(results)).dump(1) + "\n");
}

bool is_kept(const fs::path& file) {
    const std::string name = file.filename().string();
    return file.extension() == ".png" || name == kRecord || name == kLinear;
}

std::set<std::string> kept_files(const fs::path& folder) {
    std::set<std::string> names;
    if (fs::exists(folder))
        for (const auto& entry : fs::directory_iterator(folder))
            if (is_kept(entry.path())) names.insert(entry.path().filename().string());
    return names;
}

Json read_record(const fs::path& file) { return Json::parse(bytes_of(file), nullptr, false); }

/// Figures that differ by more than the last digits of pow and exp, which libraries round as they like.
void add_record_changes(const Json& before, const Json& now, std::vector<std::string>& lines) {
    const Json old_values = before.flatten(), new_values = now.flatten();
    const auto same = [](const Json& a, const Json& b) {
        if (!a.is_number_float() || !b.is_number_float()) return a == b;
        const double x = a, y = b;
        return std::abs(x - y) <= 1e-9 * std::max(std::abs(x), std::abs(y));
    };
    for (const auto& item : old_values.items())
        if (!new_values.contains(item.key())) lines.push_back(fmt::format("{}{}: is gone", kRecord, item.key()));
    for (const auto& item : new_values.items())
        if (!old_values.contains(item.key()))
            lines.push_back(fmt::format("{}{}: is new", kRecord, item.key()));
        else if (!same(old_values[item.key()], item.value()))
            lines.push_back(
                fmt::format("{}{}: {} -> {}", kRecord, item.key(), old_values[item.key()].dump(), item.value().dump()));
}

void add_image_changes(const std::string& name, const fs::path& old_file, const fs::path& new_file,
                       std::vector<std::string>& lines) {
    const Image before = read_image(old_file).image, now = read_image(new_file).image;
    if (before.width != now.width || before.height != now.height || before.channels != now.channels) {
        lines.push_back(name + ": other size or channels");
        return;
    }
    std::size_t changed = 0, first = 0;
    float largest = 0;
    for (std::size_t i = 0; i < now.pixels(); ++i) {
        float most = 0;
        for (std::size_t c = 0; c < now.channels.size(); ++c)
            most = std::max(most, std::abs(now.at(i, c) - before.at(i, c)));
        if (most > 0 && changed++ == 0) first = i;
        largest = std::max(largest, most);
    }
    if (changed > 0)
        lines.push_back(fmt::format("{}: {} of {} pixels changed, the first at {}, {}; largest change {:.3g}", name,
                                    changed, now.pixels(), first % static_cast<std::size_t>(now.width),
                                    first / static_cast<std::size_t>(now.width), largest));
}

}  // namespace

std::vector<GoldenChange> comparison_changes(const fs::path& scene, const GoldenOptions& options) {
    const std::string name = scene.stem().string();
    const auto* compared   = std::ranges::find(kCompared, name, &Compared::scene);
    if (compared == kCompared.end() || !is_wanted(options, name, "compared")) return {};
    const ScratchFolder scratch;
    run_comparison(scene, *compared, scratch.path());
    const fs::path now = scratch.path() / name, accepted = options.folder / name / "compared";
    const std::set<std::string> old_files = kept_files(accepted), new_files = kept_files(now);

    GoldenChange change;
    change.name = name + "/compared";
    change.kind = old_files.empty() ? GoldenChange::Kind::added : GoldenChange::Kind::changed;
    for (const std::string& file : old_files)
        if (!new_files.contains(file)) change.lines.push_back(file + ": is no longer written");
    for (const std::string& file : new_files)
        if (!old_files.contains(file))
            change.lines.push_back(file + ": is new");
        else if (file != kRecord)
            add_image_changes(file, accepted / file, now / file, change.lines);
    Json old_record    = old_files.contains(kRecord) ? read_record(accepted / kRecord) : Json::object();
    const Json made_on = old_record.is_object() ? old_record.value("machine", Json()) : Json();
    if (old_record.is_object()) old_record.erase("machine");
    Json record = read_record(now / kRecord);
    if (!old_files.empty()) add_record_changes(old_record, record, change.lines);
    if (change.lines.empty()) return {};
    change.rounding = !old_files.empty() && made_on != Json(rounding_machine());
    if (!options.pictures.empty() && !old_files.empty()) {
        change.pictures = options.pictures / fmt::format("{}.compared", name);
        fs::remove_all(change.pictures);
        fs::create_directories(change.pictures);
        fs::copy(accepted, change.pictures / "reference", fs::copy_options::recursive);
        fs::copy(now, change.pictures / "result", fs::copy_options::recursive);
    }
    if (options.renew) {
        record["machine"] = rounding_machine();
        write_text(now / kRecord, record.dump(1) + "\n");
        fs::remove_all(accepted);
        fs::create_directories(accepted);
        for (const std::string& file : new_files) fs::copy_file(now / file, accepted / file);
    }
    return {std::move(change)};
}

}  // namespace umbra
