#include "umbra/bench/pages/report_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/base/files.h"
#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/error_rings.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/pages/values_call.h"
#include "umbra/core/base/paths.h"
#include "umbra/core/image/image_io.h"

namespace umbra {

namespace fs = std::filesystem;
using nlohmann::json;

ScenePage page_in(const fs::path& folder, const Results& results) {
    const std::string name = folder.filename().string();
    return {.root    = {},
            .results = results,
            .data    = folder,
            .page    = folder,
            .name    = name,
            .title   = results.scene.title.empty() ? name : results.scene.title};
}

SceneFiles::SceneFiles(const ScenePage& scene, StagedFiles& staged) : scene_(scene), staged_(staged) {
    const SizeRecord& size = scene.results.size;
    if (size.width) size_["width"] = std::to_string(*size.width);
    if (size.height) size_["height"] = std::to_string(*size.height);
}

fs::path SceneFiles::found(const FileName& file) const {
    const fs::path name = file.name;
    fs::path path       = scene_.data / name;
    if (name.is_absolute() || *path.lexically_normal().lexically_relative(scene_.data).begin() == "..")
        file.at.refuse("a file in the same folder");
    if (!is_file(path)) file.at.refuse("an existing file");
    return path;
}

fs::path SceneFiles::placed(const FileName& file) const { return (scene_.page / file.name).lexically_normal(); }

std::string SceneFiles::link(const FileName& file, const fs::path& from) const {
    const fs::path path = found(file);
    if (scene_.page != scene_.data) staged_.copy(path, placed(file));
    return url(placed(file).lexically_relative(from));
}

json SceneFiles::figure(const FileName& file, const std::string& who, const std::string& what, const std::string& alt,
                        const fs::path& from) const {
    if (!file) return false;
    json view    = size_;
    view["src"]  = link(file, from.empty() ? scene_.page : from);
    view["who"]  = who;
    view["what"] = what;
    view["alt"]  = alt;
    return view;
}

Image SceneFiles::picture(const FileName& file) const { return read_image(found(file)).image; }

json SceneFiles::legend(const FileName& classes) const {
    json all = json::array();
    for (const ErrorColour* entry : classes_on(picture(classes)))
        all.push_back({{"name", std::string(entry->name)}, {"colour", std::string(entry->srgb)}});
    return all;
}

json SceneFiles::rings(const FileName& classes) const {
    if (!classes) return false;
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

json SceneFiles::values(const FileName& script) const {
    if (!script) return false;
    const std::optional<std::string> checked = checked_values(bytes_of(found(script)));
    if (!checked) script.at.refuse("a script that umbra compare wrote");
    if (scene_.page != scene_.data) staged_.write(placed(script), *checked);
    return url(placed(script).lexically_relative(scene_.page));
}

json SceneFiles::exr(const std::optional<FilesRecord>& files) const {
    if (!files || !files->exr || !is_file(scene_.data / files->exr.name)) return false;
    if (!scene_.with_exr && scene_.page != scene_.data) return false;
    return link(files->exr, scene_.page);
}

bool serves(const MethodRecord& method) { return method.serves.how != "not"; }

const LightFilesRecord* files_of(const std::optional<FilesRecord>& files, const std::string& light) {
    return files ? files->lights.find(light) : nullptr;
}

FileName picture_of(const std::optional<FilesRecord>& files) { return files ? files->png : FileName{}; }

std::string setting_text(const MethodRecord& method) {
    return !method.text.empty() ? method.text : !method.id.empty() ? method.id : method.name;
}

bool same_setting(const MethodRecord& a, const MethodRecord& b) {
    if (setting_text(a) != setting_text(b)) return false;
    return std::ranges::all_of(a.parameters, [&](const auto& parameter) {
        const Scalar* other = b.parameters.find(parameter.first);
        return other == nullptr || text_of(*other) == text_of(parameter.second);
    });
}

const MethodRecord* find_setting(const std::vector<MethodRecord>& methods, const MethodRecord& setting) {
    const auto found = std::ranges::find_if(methods, [&](const MethodRecord& m) { return same_setting(m, setting); });
    return found == methods.end() ? nullptr : &*found;
}

std::string method_label(const MethodRecord& method, const std::vector<MethodRecord>& methods) {
    // Records of two versions of the program may write other settings as one text.
    std::string others;
    for (const auto& [name, value] : method.parameters)
        if (std::ranges::any_of(methods, [&, &of = name, &here = value](const MethodRecord& m) {
                const Scalar* there = m.parameters.find(of);
                return setting_text(m) == setting_text(method) && there != nullptr && text_of(*there) != text_of(here);
            }))
            others += fmt::format("{}{}={}", others.empty() ? "" : ",", name, text_of(value));
    return label_of(method) + (others.empty() ? "" : fmt::format(" ({})", others));
}

std::vector<MethodRecord> settings_of(const std::vector<ScenePage>& scenes) {
    std::vector<MethodRecord> settings;
    for (const ScenePage& scene : scenes)
        for (const MethodRecord& method : scene.results.methods)
            if (find_setting(settings, method) == nullptr) settings.push_back(method);
    const auto answers_on = [&](const MethodRecord& setting) {
        return std::ranges::count_if(scenes, [&](const ScenePage& scene) {
            const MethodRecord* method = find_setting(scene.results.methods, setting);
            return method != nullptr && serves(*method);
        });
    };
    std::vector<std::pair<std::ptrdiff_t, MethodRecord>> ranked;
    for (const MethodRecord& setting : settings) ranked.emplace_back(answers_on(setting), setting);
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::transform(ranked.begin(), ranked.end(), settings.begin(), [](const auto& r) { return r.second; });
    return settings;
}

namespace {
std::optional<double> sum(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return std::nullopt;
    return *a + *b;
}

std::optional<double> median_of(const std::optional<TimingRecord>& timing) {
    return timing ? known(timing->median) : std::nullopt;
}
}  // namespace

std::optional<double> wrong_points(const ErrorRecord& error, std::string_view group, std::string_view member) {
    const auto in   = [&](const WrongRecord& wrong) { return member == "interior" ? wrong.interior : wrong.edge; };
    const bool both = member == "interior" || member == "edge";
    std::optional<std::uint64_t> n;
    if (group == "false_shadow" && error.false_shadow) {
        if (both || member == "acne") n = both ? in(*error.false_shadow) : error.false_shadow->acne;
    } else if (group == "false_light" && error.false_light) {
        if (both) n = in(*error.false_light);
        if (member == "detachment") n = error.false_light->detachment;
        if (member == "leak") n = error.false_light->leak;
    }
    return n ? std::optional(static_cast<double>(*n)) : std::nullopt;
}

Totals totals(const MethodRecord& method) {
    Totals t;
    double absolute = 0;
    for (const ErrorRecord& error : method.errors) {
        for (const std::string_view group : kErrorGroups) {
            t.interior += wrong_points(error, group, "interior").value_or(0);
            t.edge += wrong_points(error, group, "edge").value_or(0);
        }
        const double n = error.points ? static_cast<double>(*error.points) : error.mae ? 1 : 0;
        t.points += n;
        absolute += error.mae.value_or(0) * n;
    }
    if (t.points > 0) t.mae = absolute / t.points;
    if (!method.times) return t;
    const TimesRecord& times = method.times->phases;
    const auto visibility    = median_of(times.visibility_ms);
    t.camera_ms              = times.look_ms ? sum(visibility, median_of(times.look_ms)) : visibility;
    t.light_ms               = sum(visibility, median_of(times.aim_ms));
    t.object_ms              = sum(sum(t.camera_ms, median_of(times.aim_ms)), median_of(times.build_ms));
    return t;
}

const MethodRecord* worst_method(const Results& results) {
    const MethodRecord* worst = nullptr;
    std::pair most(-1.0, -1.0);
    for (const MethodRecord& method : results.methods) {
        if (!serves(method) || is_reference(results, method) || !picture_of(method.files)) continue;
        const Totals sums = totals(method);
        if (const std::pair wrong(sums.interior, sums.edge); wrong > most) worst = &method, most = wrong;
    }
    return worst;
}

bool is_reference(const Results& results, const MethodRecord& method) {
    return !method.text.empty() && method.text == results.reference.text;
}

json class_legend() {
    json all = json::array();
    for (const ErrorColour& entry : kErrorPalette)
        all.push_back({{"name", std::string(entry.name)},
                       {"colour", std::string(entry.srgb)},
                       {"sentence", std::string(entry.sentence)}});
    return all;
}

json slider_view(const SceneFiles& files, const MethodRecord* method, const fs::path& from) {
    const ScenePage& scene   = files.scene();
    const FileName reference = picture_of(scene.results.reference.files);
    if (method == nullptr || !reference) return false;
    const std::string label = method_label(*method, scene.results.methods);
    json left               = files.figure(picture_of(method->files), label, "picture",
                                           fmt::format("{}: shadows by {}", scene.title, label), from);
    json right =
        files.figure(reference, "Reference", "picture", fmt::format("{}: shadows by the reference", scene.title), from);
    json view     = {{"width", left.value("width", "")}, {"height", left.value("height", "")}};
    view["left"]  = std::move(left);
    view["right"] = std::move(right);
    return view;
}

json class_picture_view(const SceneFiles& files, const MethodRecord& method, const std::string& label,
                        const fs::path& from) {
    std::string light;
    FileName picture;
    double most = -1;
    for (const ErrorRecord& error : method.errors) {
        double wrong = 0;
        for (const std::string_view group : kErrorGroups) wrong += wrong_points(error, group, "interior").value_or(0);
        const LightFilesRecord* of = files_of(method.files, error.light);
        if (wrong > most && of != nullptr && of->classes) light = error.light, picture = of->classes, most = wrong;
    }
    if (!picture) return false;
    json view       = files.figure(picture, label, "errors of " + light,
                                   fmt::format("Classes of the wrong points of {} by {}", light, label), from);
    view["caption"] = fmt::format("Wrong points of {}, light “{}”. Right points are grey.", label, light);
    view["rings"]   = files.rings(picture);
    view["legend"]  = files.legend(picture);
    return view;
}

json run_view(const HeadRecord& head, const MachineRecord& machine) {
    std::vector<std::string> parts;
    if (!machine.cpu.empty()) parts.push_back(machine.cpu);
    if (machine.cores > 0) parts.push_back(counted(double(machine.cores), "core"));
    if (machine.threads > 0) parts.push_back(counted(double(machine.threads), "thread") + " used");
    if (machine.memory_bytes > 0)
        parts.push_back(fmt::format("{:.0f} GiB", double(machine.memory_bytes) / (1024.0 * 1024 * 1024)));
    if (!machine.system.empty()) parts.push_back(machine.system);
    if (!machine.compiler.empty()) parts.push_back(machine.compiler);
    const std::string command = without_folders(head.command);
    return {{"has_commands", !command.empty()},
            {"commands", json::array({command})},
            {"machine", fmt::format("{}", fmt::join(parts, ", "))},
            {"version", head.version}};
}

void add_run(json& runs, const HeadRecord& head, const MachineRecord& machine) {
    json view = run_view(head, machine);
    for (json& known : runs) {
        if (known["machine"] != view["machine"] || known["version"] != view["version"]) continue;
        json& commands = known["commands"];
        if (std::find(commands.begin(), commands.end(), view["commands"][0]) == commands.end())
            commands.push_back(view["commands"][0]);
        return;
    }
    runs.push_back(std::move(view));
}

json reference_view(const ReferenceRecord& reference) {
    return {{"title", reference.title.empty() ? in_words(reference.name) : reference.title},
            {"text", reference.text},
            {"exact", reference.exact},
            {"note", reference.note}};
}

}  // namespace umbra
