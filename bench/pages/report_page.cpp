#include "umbra/bench/pages/report_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/error_rings.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/base/paths.h"
#include "umbra/core/image/image_io.h"

namespace umbra {

namespace fs = std::filesystem;
using nlohmann::json;

SceneFiles::SceneFiles(const ScenePage& scene, StagedFiles& staged) : scene_(scene), staged_(staged) {
    for (const char* side : {"width", "height"}) {
        const Field pixels = scene.root["size"][side];
        if (!pixels.present()) continue;
        if (const double n = *pixels.number(); n < 1 || n > 1e6) pixels.refuse("1 to 1000000 pixels");
        size_[side] = fmt::format("{:.0f}", *pixels.number());
    }
}

std::string SceneFiles::link(const Field& file, const fs::path& from) const {
    const fs::path name = file.required_text();
    const fs::path path = scene_.data / name;
    if (name.is_absolute() || *path.lexically_normal().lexically_relative(scene_.data).begin() == "..")
        file.refuse("a file in the same folder");
    if (!is_file(path)) file.refuse("an existing file");
    if (scene_.page != scene_.data) staged_.copy(path, (scene_.page / name).lexically_normal());
    return url((scene_.page / name).lexically_normal().lexically_relative(from));
}

json SceneFiles::figure(const Field& file, const std::string& who, const std::string& what, const std::string& alt,
                        const fs::path& from) const {
    if (!file.present()) return false;
    json view    = size_;
    view["src"]  = link(file, from.empty() ? scene_.page : from);
    view["who"]  = who;
    view["what"] = what;
    view["alt"]  = alt;
    return view;
}

Image SceneFiles::picture(const Field& file) const {
    (void)link(file, scene_.page);  // refuses a file that lies elsewhere
    return read_image(scene_.data / file.text()).image;
}

json SceneFiles::legend(const Field& classes) const {
    json all = json::array();
    for (const ErrorColour* entry : classes_on(picture(classes)))
        all.push_back({{"name", std::string(entry->name)}, {"colour", std::string(entry->srgb)}});
    return all;
}

json SceneFiles::rings(const Field& classes) const {
    if (!classes.present()) return false;
    const Image drawn      = picture(classes);
    const ErrorRings found = error_rings(drawn);
    if (found.rings.empty()) return false;
    json shapes        = json::array();
    const auto rounded = [](double v) { return fmt::format("{:.0f}", v); };
    for (const Ring& ring : found.rings)
        shapes.push_back({{"x", rounded(ring.x)},
                          {"y", rounded(ring.y)},
                          {"w", rounded(ring.width)},
                          {"h", rounded(ring.height)},
                          {"r", rounded(std::min(ring.width, ring.height) / 2)}});
    return {{"width", std::to_string(drawn.width)},
            {"height", std::to_string(drawn.height)},
            {"words", fmt::format("{} around {} of wrong interior points.",
                                  found.rings.size() == 1 ? "1 ring" : fmt::format("{} rings", found.rings.size()),
                                  found.rings.size() == 1 ? "a small group" : "small groups")},
            {"shapes", std::move(shapes)}};
}

json SceneFiles::exr(const Field& files) const {
    const Field file = files["exr"];
    if (!file.present() || !is_file(scene_.data / file.required_text())) return false;
    if (!scene_.with_exr && scene_.page != scene_.data) return false;
    return link(file, scene_.page);
}

bool serves(const Field& method) {
    const Field how        = method["serves"]["how"];
    const std::string word = how.required_text();
    if (word != "exactly" && word != "to_rounding" && word != "approximately" && word != "not")
        how.refuse("\"exactly\", \"to_rounding\", \"approximately\" or \"not\"");
    return word != "not";
}

std::string setting_text(const Field& method) {
    if (std::string text = method["text"].text(); !text.empty()) return text;
    const std::string id = method["id"].text();
    return id.empty() ? method["name"].required_text() : id;
}

bool same_setting(const Field& a, const Field& b) {
    if (setting_text(a) != setting_text(b)) return false;
    const std::vector<std::pair<std::string, Field>> parameters = a["parameters"].members();
    return std::all_of(parameters.begin(), parameters.end(), [&](const auto& parameter) {
        const Field other = b["parameters"][parameter.first];
        return !other.present() || other.scalar() == parameter.second.scalar();
    });
}

std::optional<Field> find_setting(const std::vector<Field>& methods, const Field& setting) {
    const auto found =
        std::find_if(methods.begin(), methods.end(), [&](const Field& m) { return same_setting(m, setting); });
    return found == methods.end() ? std::nullopt : std::optional(*found);
}

std::string method_label(const Field& method, const std::vector<Field>& methods) {
    const std::string name = method["name"].required_text(), title = method["title"].text(),
                      text = method["text"].text();
    const auto runs =
        std::count_if(methods.begin(), methods.end(), [&](const Field& m) { return m["name"].text() == name; });
    const std::string shown = title.empty() ? in_words(name) : title;
    const auto colon        = text.find(':');
    std::string settings    = colon != std::string::npos ? text.substr(colon + 1) : "";
    // Records of two versions of the program may write other settings as one text.
    for (const auto& [name_of, value] : method["parameters"].members())
        if (std::any_of(methods.begin(), methods.end(), [&, &of = name_of, &here = value](const Field& m) {
                return setting_text(m) == setting_text(method) && m["parameters"][of].present() &&
                       m["parameters"][of].scalar() != here.scalar();
            }))
            settings += fmt::format("{}{}={}", settings.empty() ? "" : ",", name_of, value.scalar());
    return runs > 1 && !settings.empty() ? fmt::format("{} ({})", shown, settings) : shown;
}

std::vector<Field> settings_of(const std::vector<ScenePage>& scenes) {
    std::vector<Field> settings;
    for (const ScenePage& scene : scenes)
        for (const Field& method : scene.root["methods"].items())
            if (!find_setting(settings, method)) settings.push_back(method);
    const auto answers_on = [&](const Field& setting) {
        return std::count_if(scenes.begin(), scenes.end(), [&](const ScenePage& scene) {
            const std::optional<Field> method = find_setting(scene.root["methods"].items(), setting);
            return method && serves(*method);
        });
    };
    std::vector<std::pair<std::ptrdiff_t, Field>> ranked;
    for (const Field& setting : settings) ranked.emplace_back(answers_on(setting), setting);
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::transform(ranked.begin(), ranked.end(), settings.begin(), [](const auto& r) { return r.second; });
    return settings;
}

namespace {
std::optional<double> sum(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return std::nullopt;
    return *a + *b;
}
}  // namespace

Totals totals(const Field& method) {
    Totals t;
    double absolute = 0;
    for (const Field& error : method["errors"].items()) {
        for (const std::string& group : error_groups()) {
            t.interior += error[group]["interior"].number().value_or(0);
            t.edge += error[group]["edge"].number().value_or(0);
        }
        const auto mae = error["mae"].number();
        const double n = error["points"].number().value_or(mae ? 1 : 0);
        t.points += n;
        absolute += mae.value_or(0) * n;
    }
    if (t.points > 0) t.mae = absolute / t.points;
    const Field times     = method["times"];
    const auto visibility = times["visibility_ms"]["median"].number();
    t.camera_ms = times["look_ms"].present() ? sum(visibility, times["look_ms"]["median"].number()) : visibility;
    t.light_ms  = sum(visibility, times["aim_ms"]["median"].number());
    t.object_ms = sum(sum(t.camera_ms, times["aim_ms"]["median"].number()), times["build_ms"]["median"].number());
    return t;
}

std::vector<std::string> error_groups() {
    std::vector<std::string> groups;
    for (const ErrorColour& entry : kErrorPalette)
        if (!entry.group.empty() && std::find(groups.begin(), groups.end(), entry.group) == groups.end())
            groups.emplace_back(entry.group);
    return groups;
}

std::optional<Field> worst_method(const Field& root) {
    std::optional<Field> worst;
    double most = -1;
    for (const Field& method : root["methods"].items()) {
        if (!serves(method) || is_reference(root, method) || !method["files"]["png"].present()) continue;
        if (const double wrong = totals(method).interior; wrong > most) worst = method, most = wrong;
    }
    return worst;
}

bool is_reference(const Field& root, const Field& method) {
    const std::string text = method["text"].text();
    return !text.empty() && text == root["reference"]["text"].text();
}

json class_legend() {
    json all = json::array();
    for (const ErrorColour& entry : kErrorPalette)
        all.push_back({{"name", std::string(entry.name)},
                       {"colour", std::string(entry.srgb)},
                       {"sentence", std::string(entry.sentence)}});
    return all;
}

json slider_view(const SceneFiles& files, const std::optional<Field>& method, const fs::path& from) {
    const ScenePage& scene = files.scene();
    const Field reference  = scene.root["reference"]["files"]["png"];
    if (!method || !reference.present()) return false;
    const std::string label = method_label(*method, scene.root["methods"].items());
    json left               = files.figure((*method)["files"]["png"], label, "picture",
                                           fmt::format("{}: shadows by {}", scene.title, label), from);
    json right =
        files.figure(reference, "Reference", "picture", fmt::format("{}: shadows by the reference", scene.title), from);
    json view     = {{"width", left.value("width", "")}, {"height", left.value("height", "")}};
    view["left"]  = std::move(left);
    view["right"] = std::move(right);
    return view;
}

json run_view(const Field& root) {
    const Field machine = root["machine"];
    std::vector<std::string> parts;
    if (const auto cpu = machine["cpu"].text(); !cpu.empty()) parts.push_back(cpu);
    if (const auto n = machine["cores"].number()) parts.push_back(counted(*n, "core"));
    if (const auto n = machine["threads"].number()) parts.push_back(counted(*n, "thread") + " used");
    if (const auto n = machine["memory_bytes"].number(); n && *n > 0)
        parts.push_back(fmt::format("{:.0f} GiB", *n / (1024.0 * 1024 * 1024)));
    if (const auto s = machine["system"].text(); !s.empty()) parts.push_back(s);
    if (const auto s = machine["compiler"].text(); !s.empty()) parts.push_back(s);
    const std::string command = without_folders(root["command"].text());
    return {{"has_commands", !command.empty()},
            {"commands", json::array({command})},
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

}  // namespace umbra
