// The report: results.json files -> numbers and sentences in the shape of the page templates -> pages.
//
// The templates (bench/report/*.html) hold the words and the markup; this file fills them. The template engine is
// Mustache (kainjow's header, packaged by Debian): it escapes by default, and every name, sentence and warning here
// comes out of a file. No template uses its unescaped form.
#include "bench/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/report_assets.h"
#include "bench/report_chart.h"
#include "bench/results_file.h"
#include "core/error.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// ---- Numbers as people read them. Units stand in the tables' heads.

constexpr const char* kNone = "–";

/// Three significant digits, as 1.2·10⁻⁵ where they would stand behind too many zeros, and a minus that is one.
std::string score(std::optional<double> value) {
    if (!value) return kNone;
    const double size      = std::abs(*value);
    const std::string sign = *value < 0 ? "−" : "";
    if (size == 0) return "0";
    const int exponent = int(std::floor(std::log10(size)));
    if (exponent >= -4 && exponent < 6) return fmt::format("{}{:.{}f}", sign, size, std::max(0, 2 - exponent));
    std::string raised;
    for (const char c : std::to_string(exponent)) {
        static constexpr std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
        raised += c == '-' ? "⁻" : digits[std::size_t(c - '0')];
    }
    return fmt::format("{}{:.1f}·10{}", sign, size / std::pow(10, exponent), raised);
}

/// Whole numbers in groups of three, parted by a narrow no-break space.
std::string count(std::optional<double> value) {
    if (!value) return kNone;
    std::string digits = fmt::format("{:.0f}", *value);
    for (auto at = std::ptrdiff_t(digits.size()) - 3; at > 0; at -= 3)
        if (digits[std::size_t(at) - 1] != '-') digits.insert(std::size_t(at), "\u202f");
    return digits;
}

/// Per cent, rounded down so that 100 means all of them.
std::string percent(std::optional<double> share) {
    if (!share) return kNone;
    return fmt::format("{:g}", std::floor(*share * 1000 + 1e-9) / 10);
}

std::string mebibytes(std::optional<double> bytes) {
    return bytes ? score(*bytes / (1024.0 * 1024.0)) : std::string(kNone);
}

std::string in_words(std::string key) {
    std::replace(key.begin(), key.end(), '_', ' ');
    return key;
}

std::optional<double> sum(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return std::nullopt;
    return *a + *b;
}

// ---- Files and links

/// A relative path as it may stand in an attribute: every byte that means something in a URL is encoded.
std::string url(const fs::path& path) {
    std::string encoded;
    for (const char c : path.generic_string()) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                           c == '.' || c == '-' || c == '_' || c == '~';
        encoded += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return encoded;
}

/// Files are written and copied beside their places and moved there all together; what fails before leaves nothing.
class StagedFiles {
public:
    StagedFiles()                              = default;
    StagedFiles(const StagedFiles&)            = delete;
    StagedFiles& operator=(const StagedFiles&) = delete;
    ~StagedFiles() {
        std::error_code ignored;
        for (const fs::path& file : files_) fs::remove(beside(file), ignored);
    }

    void write(const fs::path& file, std::string_view content) {
        stage(file);
        std::ofstream stream(beside(file), std::ios::binary);
        stream.write(content.data(), std::streamsize(content.size()));
        stream.close();
        if (!stream) throw InputError(fmt::format("{}: cannot be written", file.string()));
    }
    void copy(const fs::path& from, const fs::path& to) {
        if (!stage(to)) return;
        std::error_code error;
        fs::copy_file(from, beside(to), fs::copy_options::overwrite_existing, error);
        if (error)
            throw InputError(
                fmt::format("{}: cannot be copied from {}: {}", to.string(), from.string(), error.message()));
    }
    void commit() {
        for (const fs::path& file : files_) {
            std::error_code error;
            fs::rename(beside(file), file, error);
            if (error) throw InputError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
        }
        files_.clear();
    }

private:
    static fs::path beside(fs::path file) { return file += ".part"; }
    bool stage(const fs::path& file) {
        std::error_code error;
        fs::create_directories(file.parent_path(), error);
        if (error)
            throw InputError(fmt::format("{}: cannot be made: {}", file.parent_path().string(), error.message()));
        return files_.insert(file).second;
    }
    std::set<fs::path> files_;
};

// ---- What was found

struct ScenePage {
    Field root;
    fs::path data;  ///< the folder that the paths in results.json are relative to
    fs::path page;  ///< the folder of the page; in `out`
    std::string name, title;
    double triangles = 0;
};

std::vector<fs::path> results_files(const fs::path& dir) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(dir, error))
        if (entry.is_directory() && fs::exists(entry.path() / "results.json"))
            files.push_back(entry.path() / "results.json");
    if (error)
        throw InputError(
            fmt::format("{}: {} (a folder that umbra compare wrote would be right)", dir.string(), error.message()));
    std::sort(files.begin(), files.end());
    if (files.empty() && fs::exists(dir / "results.json")) files.push_back(dir / "results.json");
    if (files.empty())
        throw InputError(fmt::format(
            "{}: holds no results.json, nor does any folder in it (a folder that umbra compare wrote would be right)",
            dir.string()));
    return files;
}

/// A scene's name as the name of a folder.
std::string folder_name(const std::string& scene) {
    std::string name;
    for (const char c : scene) name += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
    return name;
}

std::vector<ScenePage> find_scenes(const std::vector<fs::path>& dirs, const fs::path& out) {
    std::vector<ScenePage> all;
    for (const fs::path& dir : dirs) {
        const auto first = std::ptrdiff_t(all.size());
        for (const fs::path& file : results_files(dir)) {
            ScenePage scene{.root  = read_results(file),
                            .data  = fs::canonical(file.parent_path()),
                            .page  = {},
                            .name  = {},
                            .title = {}};
            scene.name      = scene.root["scene"]["name"].required_text();
            scene.title     = scene.root["scene"]["title"].text();
            scene.triangles = scene.root["facts"]["triangles"].number().value_or(0);
            if (!scene.root["methods"].present()) scene.root["methods"].refuse("an array");
            if (scene.title.empty()) scene.title = in_words(scene.name);
            const bool seen =
                std::any_of(all.begin(), all.end(), [&](const ScenePage& other) { return other.data == scene.data; });
            if (!seen) all.push_back(std::move(scene));
        }
        // From the simple to the large, which is also the order of a lecture.
        std::stable_sort(all.begin() + first, all.end(),
                         [](const ScenePage& a, const ScenePage& b) { return a.triangles < b.triangles; });
    }

    std::set<fs::path> taken;
    const auto below_out = [&](const ScenePage& scene) {
        const fs::path relative = scene.data.lexically_relative(out);
        return relative != "." && *relative.begin() != "..";
    };
    for (ScenePage& scene : all)
        if (below_out(scene)) taken.insert(scene.page = scene.data);
    for (ScenePage& scene : all) {
        for (int i = 1; scene.page.empty(); ++i) {
            const fs::path folder = out / (folder_name(scene.name) + (i > 1 ? fmt::format("-{}", i) : ""));
            if (taken.insert(folder).second) scene.page = folder;
        }
    }
    return all;
}

// ---- From fields to what the templates show

/// One scene's file made ready for its page: links, labels, and the pictures that must be there.
class SceneView {
public:
    SceneView(const ScenePage& scene, StagedFiles& staged) : scene_(scene), staged_(staged) {
        for (const char* side : {"width", "height"}) {
            const Field pixels = scene.root["size"][side];
            if (!pixels.present()) continue;
            if (const double n = *pixels.number(); n < 1 || n > 1e6) pixels.refuse("pixels, from 1 to a million,");
            size_[side] = fmt::format("{:.0f}", *pixels.number());
        }
    }

    /// The address of a file that results.json names, seen from `from`. Copied to the page where the scene lies
    /// elsewhere.
    std::string link(const Field& field, const fs::path& from) const {
        const fs::path name = field.required_text();
        const fs::path file = scene_.data / name;
        if (name.is_absolute() || *file.lexically_normal().lexically_relative(scene_.data).begin() == "..")
            field.refuse("a file in the same folder");
        if (!fs::is_regular_file(file)) field.refuse("a file that is there");
        if (scene_.page != scene_.data) staged_.copy(file, (scene_.page / name).lexically_normal());
        return url((scene_.page / name).lexically_normal().lexically_relative(from));
    }

    /// A picture and the words that go with it; false where results.json has none.
    json figure(const Field& file, const std::string& who, const std::string& what, const std::string& sees) const {
        if (!file.present()) return false;
        json view    = size_;
        view["src"]  = link(file, scene_.page);
        view["who"]  = who;
        view["what"] = what;
        view["alt"]  = sees;
        return view;
    }

    /// EXRs are large and may have been left out of a folder that is handed out; then there is no link.
    json exr(const Field& files) const {
        const Field file = files["exr"];
        if (!file.present() || !fs::is_regular_file(scene_.data / file.required_text())) return false;
        return link(file, scene_.page);
    }

    const ScenePage& scene() const { return scene_; }

private:
    const ScenePage& scene_;
    StagedFiles& staged_;
    json size_ = json::object();
};

std::string kind_in_words(const std::string& kind) {
    const bool area = kind == "rectangle" || kind == "disk" || kind == "sphere";
    return kind.empty() ? kind : kind + (area ? " light (area)" : " light");
}

std::string place_in_words(const std::string& place) {
    if (place == "at_infinity") return "at infinity";
    if (place == "outside_view") return "outside the view";
    if (place == "inside_view") return "inside the view";
    if (place == "at_eye") return "at the eye";
    return in_words(place);
}

bool serves(const Field& method) {
    const Field how        = method["serves"]["how"];
    const std::string word = how.required_text();
    if (word != "exactly" && word != "approximately" && word != "not")
        how.refuse("\"exactly\", \"approximately\" or \"not\"");
    return word != "not";
}

std::string method_id(const Field& method) {
    const std::string id = method["id"].text();
    return id.empty() ? method["name"].required_text() : id;
}

/// What a method is called on a page. Where one method runs with several settings, these tell the runs apart.
std::string method_label(const Field& method, const std::vector<Field>& methods) {
    const std::string name = method["name"].required_text(), title = method["title"].text(),
                      text = method["text"].text();
    const auto runs =
        std::count_if(methods.begin(), methods.end(), [&](const Field& m) { return m["name"].text() == name; });
    const std::string shown = title.empty() ? in_words(name) : title;
    const auto colon        = text.find(':');
    return runs > 1 && colon != std::string::npos ? fmt::format("{} ({})", shown, text.substr(colon + 1)) : shown;
}

json parameters(const Field& method) {
    json all = json::array();
    for (const auto& [name, value] : method["parameters"].members())
        all.push_back({{"name", name}, {"value", value.text()}});
    return all;
}

/// Sums over the lights: what the matrix and the chart show of one method on one scene.
struct Totals {
    double interior = 0, edge = 0;
    std::optional<double> mae;  ///< mean over all points of all lights
    std::optional<double> object_ms, light_ms, camera_ms;
};

Totals totals(const Field& method) {
    Totals t;
    double points = 0, absolute = 0;
    for (const Field& error : method["errors"].items()) {
        for (const char* kind : {"false_shadow", "false_light"}) {
            t.interior += error[kind]["interior"].number().value_or(0);
            t.edge += error[kind]["edge"].number().value_or(0);
        }
        if (const auto mae = error["mae"].number()) {
            const double n = error["points"].number().value_or(1);
            points += n;
            absolute += *mae * n;
        }
    }
    if (points > 0) t.mae = absolute / points;
    const Field times = method["times"];
    t.camera_ms       = times["visibility_ms"]["median"].number();
    t.light_ms        = sum(t.camera_ms, times["aim_ms"]["median"].number());
    t.object_ms       = sum(t.light_ms, times["build_ms"]["median"].number());
    return t;
}

json timing(const Field& time) {
    const auto median = time["median"].number(), min = time["min"].number(), max = time["max"].number();
    json view = {{"median", score(median)}, {"range", false}};
    if (median && min && max && *min != *max) view["range"] = fmt::format("{}–{}", score(min), score(max));
    return view;
}

std::string percent_words(const Field& method) {
    const auto coverage = method["coverage"].number();
    return coverage && *coverage < 1 ? fmt::format("covers {} %", percent(coverage)) : std::string();
}

/// The pictures of S_j and of its difference, one row a light, one column a method.
json light_views(const SceneView& scene, const std::vector<Field>& methods) {
    const Field root = scene.scene().root;
    json all         = json::array();
    for (const Field& light : root["lights"].items()) {
        const std::string name = light["name"].required_text();
        json columns           = json::array();
        json reference =
            scene.figure(root["reference"]["files"]["lights"][name]["visibility"], "Reference", "S of " + name,
                         fmt::format("S_j of {} by the reference: lit points white, umbra black, penumbra grey", name));
        for (const Field& method : methods) {
            if (!serves(method)) continue;
            const std::string label = method_label(method, methods);
            const Field files       = method["files"]["lights"][name];
            json column             = {{"label", label}, {"coverage", percent_words(method)}};
            column["visibility"] =
                scene.figure(files["visibility"], label, "S of " + name,
                             fmt::format("S_j of {} by {}: lit points white, umbra black, penumbra grey", name, label));
            std::string wrong;
            for (const Field& error : method["errors"].items())
                if (error["light"].text() == name)
                    wrong = fmt::format("interior: {} false shadow, {} false light",
                                        count(error["false_shadow"]["interior"].number()),
                                        count(error["false_light"]["interior"].number()));
            column["wrong"] = wrong;
            column["difference"] =
                scene.figure(files["difference"], label, "difference of " + name,
                             fmt::format("S_j of {}, {} less the reference: false shadow blue, false light red; {}",
                                         name, label, wrong));
            columns.push_back(std::move(column));
        }
        all.push_back({{"id", fmt::format("light-{}", all.size() + 1)},
                       {"name", name},
                       {"kind", kind_in_words(light["kind"].text())},
                       {"place", place_in_words(light["place"].text())},
                       {"reference", std::move(reference)},
                       {"columns", std::move(columns)}});
    }
    return all;
}

/// The table of errors: a group of rows a light. Columns that no method fills are left out.
json error_view(const Field& root, const std::vector<Field>& methods) {
    json groups   = json::array();
    bool has_acne = false, has_detachment = false, has_leak = false, has_displacement = false;
    for (const Field& light : root["lights"].items()) {
        const std::string name = light["name"].required_text();
        json rows              = json::array();
        for (const Field& method : methods)
            for (const Field& e : method["errors"].items()) {
                if (e["light"].required_text() != name) continue;
                const Field shadow = e["false_shadow"], lit = e["false_light"],
                            displacement = e["edge_displacement_px"];
                has_acne |= shadow["acne"].present();
                has_detachment |= lit["detachment"].present();
                has_leak |= lit["leak"].present();
                has_displacement |= displacement.present();
                const auto wrong = [](std::optional<double> n) {
                    return json{{"n", count(n)}, {"wrong", n && *n > 0}};
                };
                rows.push_back({{"label", method_label(method, methods)},
                                {"coverage", percent(method["coverage"].number())},
                                {"points", count(e["points"].number())},
                                {"undefined", count(e["undefined"].number())},
                                {"on_boundary", count(e["on_boundary"].number())},
                                {"lit", count(e["lit"].number())},
                                {"umbra", count(e["umbra"].number())},
                                {"penumbra", count(e["penumbra"].number())},
                                {"shadow_interior", wrong(shadow["interior"].number())},
                                {"shadow_edge", count(shadow["edge"].number())},
                                {"acne", count(shadow["acne"].number())},
                                {"light_interior", wrong(lit["interior"].number())},
                                {"light_edge", count(lit["edge"].number())},
                                {"detachment", count(lit["detachment"].number())},
                                {"leak", count(lit["leak"].number())},
                                {"displacement_mean", score(displacement["mean"].number())},
                                {"displacement_max", score(displacement["max"].number())},
                                {"mae", score(e["mae"].number())},
                                {"rmse", score(e["rmse"].number())},
                                {"max", score(e["max"].number())},
                                {"bias", score(e["bias"].number())}});
            }
        if (!rows.empty()) groups.push_back({{"light", name}, {"rows", std::move(rows)}});
    }
    return {{"groups", std::move(groups)},
            {"has_acne", has_acne},
            {"has_detachment", has_detachment},
            {"has_leak", has_leak},
            {"has_displacement", has_displacement},
            {"shadow_columns", std::to_string(2 + has_acne)},
            {"light_columns", std::to_string(2 + has_detachment + has_leak)},
            {"all_columns", std::to_string(11 + has_acne + has_detachment + has_leak + 2 * has_displacement)}};
}

json time_view(const Field& root, const std::vector<Field>& methods) {
    json rows = json::array(), by_light = json::array(), shared = json::array();
    for (const Field& method : methods) {
        if (!serves(method)) continue;
        const Totals t    = totals(method);
        const Field times = method["times"];
        rows.push_back({{"label", method_label(method, methods)},
                        {"build", timing(times["build_ms"])},
                        {"aim", timing(times["aim_ms"])},
                        {"visibility", timing(times["visibility_ms"])},
                        {"object", score(t.object_ms)},
                        {"light", score(t.light_ms)},
                        {"camera", score(t.camera_ms)},
                        {"memory", mebibytes(method["memory_bytes"].number())}});
        for (const Field& light : method["light_times"].items())
            by_light.push_back({{"label", method_label(method, methods)},
                                {"light", light["light"].required_text()},
                                {"aim", timing(light["aim_ms"])},
                                {"visibility", timing(light["visibility_ms"])}});
    }
    for (const auto& [key, name] : {std::pair{"load_ms", "reading the scene"},
                                    {"facts_ms", "finding its facts"},
                                    {"rays_build_ms", "the ray tracer's tree"},
                                    {"gbuffer_ms", "the points that the camera sees"},
                                    {"shade_ms", "the sum, once"}})
        if (const auto ms = root["times"][key].number()) shared.push_back({{"name", name}, {"ms", score(ms)}});
    const bool several = root["lights"].items().size() > 1 && !by_light.empty();
    return {{"rows", std::move(rows)},
            {"several_lights", several},
            {"by_light", std::move(by_light)},
            {"shared", std::move(shared)}};
}

json fact_view(const Field& root) {
    const Field facts = root["facts"];
    json requirements = json::array(), not_required = json::array(), objects = json::array();
    for (const Field& f : facts["requires"].items()) requirements.push_back(f.required_text());
    for (const Field& f : facts["not_required"].items()) not_required.push_back(f.required_text());
    for (const Field& o : facts["objects"].items()) {
        json faults = json::array();
        for (const auto& [key, words] : {std::pair{"boundary_edges", "boundary edges"},
                                         {"nonmanifold_edges", "non-manifold edges"},
                                         {"misoriented_edges", "misoriented edges"},
                                         {"nonmanifold_vertices", "non-manifold vertices"},
                                         {"degenerate_triangles", "degenerate triangles"},
                                         {"duplicate_triangles", "duplicate triangles"}})
            if (const auto n = o[key].number(); n && *n > 0) faults.push_back(fmt::format("{} {}", count(n), words));
        const bool closed = o["closed"].flag(), outward = o["outward"].flag(), planar = o["planar"].flag();
        objects.push_back({{"name", o["name"].text()},
                           {"triangles", count(o["triangles"].number())},
                           {"vertices", count(o["vertices"].number())},
                           {"components", count(o["components"].number())},
                           {"shape", fmt::format("{}{}", closed ? (outward ? "closed" : "closed, inside out") : "open",
                                                 planar ? ", planar" : "")},
                           {"area", score(o["area"].number())},
                           {"volume", closed ? score(o["volume"].number()) : kNone},
                           {"faults", std::move(faults)}});
    }
    const auto planes = facts["planes"].items().size();
    return {{"triangles", count(facts["triangles"].number())},
            {"planes", std::to_string(planes)},
            {"planar_share", percent(facts["planar_area_share"].number())},
            {"requires", std::move(requirements)},
            {"not_required", std::move(not_required)},
            {"has_objects", !objects.empty()},
            {"objects", std::move(objects)}};
}

json machine_view(const Field& root) {
    const Field machine = root["machine"];
    std::vector<std::string> parts;
    if (const auto cpu = machine["cpu"].text(); !cpu.empty()) parts.push_back(cpu);
    if (const auto n = machine["cores"].number()) parts.push_back(fmt::format("{:.0f} cores", *n));
    if (const auto n = machine["threads"].number()) parts.push_back(fmt::format("{:.0f} threads used", *n));
    if (const auto n = machine["memory_bytes"].number(); n && *n > 0)
        parts.push_back(fmt::format("{:.0f} GiB", *n / (1024.0 * 1024 * 1024)));
    if (const auto s = machine["system"].text(); !s.empty()) parts.push_back(s);
    if (const auto s = machine["compiler"].text(); !s.empty()) parts.push_back(s);
    return {{"command", root["command"].text()},
            {"machine", fmt::format("{}", fmt::join(parts, ", "))},
            {"version", root["version"].text()}};
}

json reference_view(const Field& root) {
    const Field reference   = root["reference"];
    const std::string title = reference["title"].text();
    return {{"title", title.empty() ? in_words(reference["name"].text()) : title},
            {"text", reference["text"].text()},
            {"exact", reference["exact"].flag()},
            {"note", reference["note"].text()}};
}

std::string size_in_words(const Field& root) {
    const auto w = root["size"]["width"].number(), h = root["size"]["height"].number();
    return w && h ? fmt::format("{:.0f} × {:.0f}", *w, *h) : std::string();
}

/// Everything that templates/scene.html shows of one scene. `styles` gives each method the same mark on every page.
json scene_view(const SceneView& scene, const std::vector<std::string>& styles) {
    const Field root                 = scene.scene().root;
    const std::vector<Field> methods = root["methods"].items();
    json pictures = json::array(), used = json::array(), unserved = json::array(), image = json::array(),
         files = json::array();
    std::vector<ChartPoint> chart;

    const Field reference = root["reference"];
    if (json f = scene.figure(reference["files"]["png"], "Reference", "picture",
                              fmt::format("{}: the picture with the reference's shadows", scene.scene().title));
        f.is_object()) {
        f["note"] = reference["exact"].flag() ? "exact" : "sampled, not exact";
        pictures.push_back(std::move(f));
    }
    if (const json exr = scene.exr(reference["files"]); exr.is_string())
        files.push_back({{"label", "Reference"}, {"href", exr}});

    for (const Field& method : methods) {
        const std::string label = method_label(method, methods), id = method_id(method);
        const bool served = serves(method);
        used.push_back({{"label", label},
                        {"how", served ? method["serves"]["how"].text() : "not served"},
                        {"why", method["serves"]["why"].text()},
                        {"parameters", parameters(method)}});
        if (!served) {
            unserved.push_back({{"label", label}, {"why", method["serves"]["why"].text()}});
            continue;
        }
        const Totals t = totals(method);
        if (json f = scene.figure(method["files"]["png"], label, "picture",
                                  fmt::format("{}: the picture with the shadows of {}", scene.scene().title, label));
            f.is_object()) {
            const std::string coverage = percent_words(method);
            f["note"] = fmt::format("{} wrong in the interior, {} ms{}{}", count(t.interior), score(t.object_ms),
                                    coverage.empty() ? "" : "; ", coverage);
            pictures.push_back(std::move(f));
        }
        const Field scores = method["image"];
        image.push_back(
            {{"label", label},
             {"rmse", score(scores["rmse"].number())},
             {"psnr", scores["psnr"].present()       ? fmt::format("{:.1f}", *scores["psnr"].number())
                      : scores["rmse"].number() == 0 ? "∞"
                                                     : kNone},
             {"ssim", scores["ssim"].present() ? fmt::format("{:.4f}", *scores["ssim"].number()) : kNone},
             {"flip", score(scores["flip"].number())},
             {"map",
              scene.figure(method["files"]["flip"], label, "FLIP map",
                           fmt::format("FLIP map of {}: bright where a viewer would see a difference", label))}});
        if (t.mae && t.camera_ms && t.object_ms) {
            const auto style = std::find(styles.begin(), styles.end(), id) - styles.begin();
            chart.push_back({label, *t.camera_ms, *t.object_ms, *t.mae, std::size_t(style)});
        }
        if (const json exr = scene.exr(method["files"]); exr.is_string())
            files.push_back({{"label", label}, {"href", exr}});
    }

    json warnings = json::array();
    for (const Field& w : root["scene"]["warnings"].items()) warnings.push_back(w.required_text());
    json view            = {{"title", scene.scene().title},
                            {"shows", root["scene"]["shows"].text()},
                            {"source", root["scene"]["source"].text()},
                            {"size", size_in_words(root)},
                            {"warnings", std::move(warnings)},
                            {"pictures", std::move(pictures)},
                            {"lights", light_views(scene, methods)},
                            {"errors", error_view(root, methods)},
                            {"times", time_view(root, methods)},
                            {"has_image", !image.empty()},
                            {"image", std::move(image)},
                            {"methods", std::move(used)},
                            {"has_unserved", !unserved.empty()},
                            {"unserved", std::move(unserved)},
                            {"facts", fact_view(root)},
                            {"reference", reference_view(root)},
                            {"run", machine_view(root)},
                            {"files", std::move(files)}};
    view["has_warnings"] = !view["warnings"].empty();
    view["chart"]        = chart.empty() ? json(false) : error_time_chart(chart);
    return view;
}

/// The methods of all scenes in the order in which they first appear, by their ids.
std::vector<std::string> method_ids(const std::vector<ScenePage>& scenes) {
    std::vector<std::string> ids;
    for (const ScenePage& scene : scenes)
        for (const Field& method : scene.root["methods"].items())
            if (const std::string id = method_id(method); std::find(ids.begin(), ids.end(), id) == ids.end())
                ids.push_back(id);
    return ids;
}

/// One cell of the summary: a method on a scene.
json cell_view(const ScenePage& scene, const std::string& id, const std::string& href) {
    const std::vector<Field> methods = scene.root["methods"].items();
    const auto method =
        std::find_if(methods.begin(), methods.end(), [&](const Field& m) { return method_id(m) == id; });
    json view = {{"served", false}, {"unserved", false}, {"absent", method == methods.end()}};
    if (method == methods.end()) return view;
    if (!serves(*method)) {
        view["unserved"] = json{{"why", (*method)["serves"]["why"].text()}, {"href", href + "#not-served"}};
        return view;
    }
    const Totals t      = totals(*method);
    const auto coverage = (*method)["coverage"].number();
    view["served"]      = json{{"coverage", percent(coverage)},
                          {"partial", coverage && *coverage < 1},
                          {"interior", count(t.interior)},
                          {"wrong", t.interior > 0},
                          {"edge", count(t.edge)},
                          {"mae", score(t.mae)},
                          {"ms", score(t.object_ms)},
                          {"raw_mae", t.mae ? fmt::format("{}", *t.mae) : ""},
                          {"raw_ms", t.object_ms ? fmt::format("{}", *t.object_ms) : ""},
                          {"raw_coverage", coverage ? fmt::format("{}", *coverage) : ""}};
    return view;
}

json index_view(const std::vector<ScenePage>& scenes, const std::vector<SceneView>& views, const fs::path& out,
                const ReportOptions& options) {
    json cards = json::array(), columns = json::array(), rows = json::array(), runs = json::array(),
         references                    = json::array();
    const std::vector<std::string> ids = method_ids(scenes);

    for (const std::string& id : ids)
        for (const ScenePage& scene : scenes) {
            const std::vector<Field> methods = scene.root["methods"].items();
            const auto method =
                std::find_if(methods.begin(), methods.end(), [&](const Field& m) { return method_id(m) == id; });
            if (method == methods.end()) continue;
            columns.push_back({{"label", method_label(*method, methods)},
                               {"anchor", fmt::format("method-{}", columns.size() + 1)},
                               {"paper", (*method)["paper"].text()},
                               {"summary", (*method)["summary"].text()},
                               {"name", method_id(*method)}});
            break;
        }
    const auto add_once = [](json& list, json view) {
        if (std::find(list.begin(), list.end(), view) == list.end()) list.push_back(std::move(view));
    };
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const ScenePage& scene = scenes[i];
        const std::string href = url((scene.page / "index.html").lexically_relative(out));
        std::vector<std::string> lights;
        for (const Field& light : scene.root["lights"].items())
            lights.push_back(
                fmt::format("{}, {}", kind_in_words(light["kind"].text()), place_in_words(light["place"].text())));
        std::sort(lights.begin(), lights.end());
        lights.erase(std::unique(lights.begin(), lights.end()), lights.end());
        json card         = {{"href", href},
                             {"title", scene.title},
                             {"shows", scene.root["scene"]["shows"].text()},
                             {"lights", fmt::format("{}", fmt::join(lights, "; "))},
                             {"triangles", count(scene.triangles)}};
        card["thumbnail"] = views[i].figure(scene.root["reference"]["files"]["png"], "Reference", "picture", "");
        if (card["thumbnail"].is_object())
            card["thumbnail"]["src"] = views[i].link(scene.root["reference"]["files"]["png"], out);
        json cells = json::array();
        for (const std::string& id : ids) cells.push_back(cell_view(scene, id, href));
        rows.push_back({{"title", scene.title}, {"href", href}, {"cells", std::move(cells)}});
        cards.push_back(std::move(card));
        add_once(runs, machine_view(scene.root));
        add_once(references, reference_view(scene.root));
    }
    return {{"title", options.title},
            {"scene_count", std::to_string(scenes.size())},
            {"method_count", std::to_string(ids.size())},
            {"scenes", std::move(cards)},
            {"columns", std::move(columns)},
            {"rows", std::move(rows)},
            {"runs", std::move(runs)},
            {"references", std::move(references)}};
}

// ---- Templates

/// Empty strings and lists are false to a template, so that {{#x}} asks whether there is anything to show.
kainjow::mustache::data template_data(const json& view) {
    if (view.is_boolean()) return view.get<bool>();
    if (view.is_string()) {
        if (view.get_ref<const std::string&>().empty()) return false;
        return view.get<std::string>();
    }
    if (view.is_array()) {
        kainjow::mustache::data list(kainjow::mustache::data::type::list);
        for (const json& item : view) list << template_data(item);
        return list;
    }
    kainjow::mustache::data object;
    for (const auto& entry : view.items()) object.set(entry.key(), template_data(entry.value()));
    return object;
}

std::string render(std::string_view page, const json& view) {
    kainjow::mustache::data data = template_data(view);
    data.set("head", std::string(assets::head_html));
    data.set("scales", std::string(assets::scales_html));
    data.set("scale_colours", std::string(assets::scale_colours_html));
    kainjow::mustache::mustache text{std::string(page)};
    std::string html = text.render(data);
    if (!text.is_valid()) throw std::logic_error("report template: " + text.error_message());
    return html;
}

}  // namespace

void write_report(const std::vector<fs::path>& dirs, const fs::path& out, const ReportOptions& options) {
    if (dirs.empty()) throw UsageError("report: no folder given (one that umbra compare wrote would be right)");
    const fs::path root                  = fs::weakly_canonical(fs::absolute(out));
    const std::vector<ScenePage> scenes  = find_scenes(dirs, root);
    const std::vector<std::string> order = method_ids(scenes);

    StagedFiles staged;
    std::vector<SceneView> views;
    for (const ScenePage& scene : scenes) views.emplace_back(scene, staged);

    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const fs::path& page = scenes[i].page;
        const auto neighbour = [&](std::size_t k) {
            return json{{"title", scenes[k].title},
                        {"href", url((scenes[k].page / "index.html").lexically_relative(page))}};
        };
        json view        = scene_view(views[i], order);
        view["root"]     = url(root.lexically_relative(page) / "");
        view["report"]   = options.title;
        view["previous"] = i > 0 ? neighbour(i - 1) : json(false);
        view["next"]     = i + 1 < scenes.size() ? neighbour(i + 1) : json(false);
        if (page != scenes[i].data) staged.copy(scenes[i].data / "results.json", page / "results.json");
        staged.write(page / "index.html", render(assets::scene_html, view));
    }
    json index    = index_view(scenes, views, root, options);
    index["root"] = "";
    staged.write(root / "index.html", render(assets::index_html, index));
    staged.write(root / "report.css", assets::report_css);
    staged.write(root / "report.js", assets::report_js);
    staged.commit();
}

}  // namespace umbra
