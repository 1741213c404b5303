#include "umbra/bench/golden/golden.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <set>

#include "umbra/bench/compare/pictures.h"
#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/explain.h"
#include "umbra/bench/run/reference.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr Size kPlaneSize{96, 54}, kFigureSize{320, 180};
constexpr float kOnBoundaryCode = -1;
constexpr int kRangeSeeds       = 32;
constexpr double kRangeWidth = 6;  // standard deviations: were the seed another, a figure would leave its range about
                                   // twice in a million (Student's t, 31 degrees of freedom, one new value)
constexpr std::size_t kPictureScale = 4;

bool wanted(const GoldenOptions& options, const std::string& scene, std::string_view method) {
    const auto is_it = [&](const std::string& name) {
        return name == scene || name == method || name == fmt::format("{}/{}", scene, method);
    };
    return options.names.empty() || std::any_of(options.names.begin(), options.names.end(), is_it);
}

// ---- planes ---------------------------------------------------------------------------------------------------------

/// The planes that are kept; no channels where all answers are sampled.
Image coded(const PreparedScene& prepared, const MethodRun& run) {
    std::vector<std::string> channels;
    std::vector<const VisibilityPlane*> planes;
    for (LightId j = 0; j < run.planes.size(); ++j) {
        const Light& light = prepared.scene.lights[j];
        if (is_sampled(run.choice, light)) continue;
        channels.push_back("S." + light.name);
        planes.push_back(&run.planes[j]);
    }
    Image image(kPlaneSize.width, kPlaneSize.height, std::move(channels));
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (std::size_t c = 0; c < planes.size(); ++c)
            image.at(i, c) = planes[c]->answer[i] == Answer::undefined     ? std::numeric_limits<float>::quiet_NaN()
                             : planes[c]->answer[i] == Answer::on_boundary ? kOnBoundaryCode
                                                                           : planes[c]->s[i];
    image.metadata = {{"umbra:scene", prepared.scene.name}, {"umbra:method", std::string(run.choice.info->name)}};
    return image;
}

/// The plane of one channel, as methods write it.
VisibilityPlane decoded(const Image& image, std::size_t channel) {
    VisibilityPlane plane(image.pixels());
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const float x   = image.at(i, channel);
        plane.answer[i] = std::isnan(x)          ? Answer::undefined
                          : x == kOnBoundaryCode ? Answer::on_boundary
                                                 : Answer::given;
        plane.s[i]      = std::isnan(x) ? 0 : std::abs(x);  // a point on the boundary is shown as lit
    }
    return plane;
}

bool same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

std::optional<std::size_t> channel_named(const Image& image, const std::string& name) {
    const auto at = std::find(image.channels.begin(), image.channels.end(), name);
    if (at == image.channels.end()) return std::nullopt;
    return static_cast<std::size_t>(at - image.channels.begin());
}

struct ChangedPlane {
    LightId light           = 0;
    std::size_t old_channel = 0, new_channel = 0;
};

struct Changes {
    std::vector<std::string> lines;
    std::vector<ChangedPlane> planes;
    bool at_edges_alone = true;
    void add(std::string line, bool at_edges) {
        lines.push_back(std::move(line));
        at_edges_alone &= at_edges;
    }
};

Changes plane_changes(const Image& before, const Image& now, const PreparedScene& prepared) {
    Changes changes;
    if (before.width != now.width || before.height != now.height) {
        changes.add(fmt::format("size of the planes: {}x{} -> {}x{} points", before.width, before.height, now.width,
                                now.height),
                    false);
        return changes;
    }
    for (const std::string& name : before.channels)
        if (!channel_named(now, name)) changes.add(name + " is no longer stored", false);
    const auto width = static_cast<std::size_t>(now.width);
    for (LightId j = 0; j < prepared.scene.lights.size(); ++j) {
        const Light& light     = prepared.scene.lights[j];
        const std::string name = "S." + light.name;
        const auto old_channel = channel_named(before, name), new_channel = channel_named(now, name);
        if (!new_channel) continue;
        if (!old_channel) {
            changes.add(name + " is new", false);
            continue;
        }
        // In both planes' bands, so that a point which is wrong amid its likes makes no edge of its own.
        const auto band_of = [&](const Image& image, std::size_t channel) {
            return edge_band(prepared.points, j, decoded(image, channel), visibility_tolerance(light.kind));
        };
        const auto old_band = band_of(before, *old_channel), new_band = band_of(now, *new_channel);
        std::size_t changed = 0, in_band = 0, first = 0;
        float largest = 0;
        for (std::size_t i = 0; i < now.pixels(); ++i) {
            const float a = before.at(i, *old_channel), b = now.at(i, *new_channel);
            if (same(a, b)) continue;
            if (changed++ == 0) first = i;
            in_band += old_band[i] && new_band[i];
            largest = std::max(largest, std::isnan(a) || std::isnan(b) ? 1 : std::abs(a - b));
        }
        if (changed == 0) continue;
        changes.planes.push_back({j, *old_channel, *new_channel});
        changes.add(fmt::format("{}: {} of {} points changed, {} of them in the edge band, the first at pixel {}, {}; "
                                "largest change {:.6g}",
                                name, changed, now.pixels(), in_band, first % width, first / width, largest),
                    in_band == changed);
    }
    return changes;
}

// ---- pictures -------------------------------------------------------------------------------------------------------

/// Every pixel k x k pixels large.
Image enlarged(const Image& image, std::size_t k) {
    Image large(image.width * static_cast<int>(k), image.height * static_cast<int>(k), image.channels);
    const auto width = static_cast<std::size_t>(large.width);
    for (std::size_t i = 0; i < large.pixels(); ++i) {
        const std::size_t from = i / width / k * static_cast<std::size_t>(image.width) + i % width / k;
        for (std::size_t c = 0; c < image.channels.size(); ++c) large.at(i, c) = image.at(from, c);
    }
    return large;
}

/// Every point that changed, however little: blue darker, orange brighter, purple where only one of the two is defined;
/// the others show the reference in a faint grey.
Image change_picture(const Image& before, const Image& now, const ChangedPlane& changed) {
    constexpr vec3 darker(0, 0.45f, 0.70f), brighter(0.90f, 0.40f, 0), undefined(0.80f, 0.47f, 0.65f);
    Image picture(now.width, now.height, {"R", "G", "B"});
    for (std::size_t i = 0; i < now.pixels(); ++i) {
        const float a = before.at(i, changed.old_channel), b = now.at(i, changed.new_channel);
        vec3 colour(std::isnan(a) ? 0.6f : 0.7f + 0.25f * std::abs(a));
        if (!same(a, b)) colour = std::isnan(a) || std::isnan(b) ? undefined : b < a ? darker : brighter;
        for (int k = 0; k < 3; ++k) picture.at(i, static_cast<std::size_t>(k)) = colour[k];
    }
    return picture;
}

void leave_pictures(const fs::path& folder, const PreparedScene& prepared, const Image& before, const Image& now,
                    const std::vector<ChangedPlane>& changed) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    const auto write = [&](const std::string& name, const Image& picture) {
        write_image(folder / name, enlarged(picture, kPictureScale));
    };
    for (const ChangedPlane& c : changed) {
        const VisibilityPlane reference = decoded(before, c.old_channel), result = decoded(now, c.new_channel);
        const std::string& light = prepared.scene.lights[c.light].name;
        write(fmt::format("reference.S.{}.png", light), visibility_picture(prepared.points, reference));
        write(fmt::format("result.S.{}.png", light), visibility_picture(prepared.points, result));
        write(fmt::format("difference.S.{}.png", light), change_picture(before, now, c));
    }
    if (!before.channels.empty()) write_image(folder / "reference.exr", before);
    if (!now.channels.empty()) write_image(folder / "result.exr", now);
}

// ---- figures --------------------------------------------------------------------------------------------------------

Json figures_of(const PreparedScene& prepared, const MethodRun& run, const MethodRun& exact) {
    Json figures = Json::object();
    for (LightId j = 0; j < run.planes.size(); ++j) {
        const Explained explained     = explain(prepared.scene, prepared.points, j, run, exact);
        const VisibilityError& e      = explained.error;
        const EdgeDisplacement edges  = explained.displacement.value_or(EdgeDisplacement{});
        const PenumbraWidth penumbrae = explained.penumbra_width.value_or(PenumbraWidth{});

        figures[prepared.scene.lights[j].name] = {{"points", e.points},
                                                  {"undefined", e.undefined},
                                                  {"on_boundary", e.on_boundary},
                                                  {"lit", e.lit},
                                                  {"umbra", e.umbra},
                                                  {"penumbra", e.penumbra},
                                                  {"false_shadow_interior", e.false_shadow.interior},
                                                  {"acne", e.acne},
                                                  {"false_shadow_edge", e.false_shadow.edge},
                                                  {"false_light_interior", e.false_light.interior},
                                                  {"detachment", e.detachment},
                                                  {"leak", e.leak},
                                                  {"false_light_edge", e.false_light.edge},
                                                  {"terminator_wrong", e.terminator.wrong},
                                                  {"mae", e.mae},
                                                  {"edge_pieces", edges.pieces},
                                                  {"edge_unmatched", edges.unmatched},
                                                  {"edge_displacement_mean", edges.mean},
                                                  {"edge_displacement_max", edges.max},
                                                  {"penumbra_width", penumbrae.method}};
        if (!is_area(prepared.scene.lights[j].kind)) continue;
        Json& area                    = figures[prepared.scene.lights[j].name];
        area["penumbra_false_shadow"] = e.penumbra_error.false_shadow;
        area["penumbra_false_light"]  = e.penumbra_error.false_light;
    }
    return figures;
}

bool is_range(const Json& figure) {
    return figure.is_array() && figure.size() == 2 && figure[0].is_number() && figure[1].is_number();
}

/// Adds what is not as accepted. Accepted figures alone may be ranges.
void add_figure_changes(const Json& accepted, const Json& now, Changes& changes) {
    for (const auto& light : accepted.items())
        if (!now.contains(light.key())) changes.add(light.key() + ": no longer in the scene", false);
    for (const auto& light : now.items()) {
        const Json old = accepted.value(light.key(), Json::object());
        if (old.empty()) {
            changes.add(light.key() + ": figures are new", false);
            continue;
        }
        for (const auto& item : old.items())
            if (!light.value().contains(item.key()))
                changes.add(fmt::format("{}: {} is no longer measured", light.key(), item.key()), false);
        std::vector<std::string> fresh;
        for (const auto& item : light.value().items()) {
            const std::string name = fmt::format("{}: {}", light.key(), item.key());
            const Json& value      = item.value();
            const bool at_edges =
                item.key().find("edge") != std::string::npos || item.key() == "mae" || item.key() == "penumbra_width";
            if (!old.contains(item.key())) {
                fresh.push_back(item.key());
            } else if (const Json& before = old[item.key()]; is_range(before)) {
                const bool below = value<before[0], above = value> before[1];
                if (below || above)
                    changes.add(fmt::format("{} {} is {} its range {}", name, value.dump(), below ? "below" : "above",
                                            before.dump()),
                                false);
            } else if (before != value) {
                changes.add(fmt::format("{} {} -> {}", name, before.dump(), value.dump()), at_edges);
            }
        }
        if (!fresh.empty()) changes.add(fmt::format("{}: new figures {}", light.key(), fmt::join(fresh, ", ")), false);
    }
}

/// The figures as ranges, for the lights whose answers are sampled.
Json with_ranges(Json figures, const PreparedScene& prepared, const MethodChoice& choice, const MethodRun& exact) {
    const std::vector<Light>& lights = prepared.scene.lights;
    if (std::none_of(lights.begin(), lights.end(), [&](const Light& l) { return is_sampled(choice, l); }))
        return figures;
    std::vector<Json> samples;
    for (int k = 0; k < kRangeSeeds; ++k) {
        MethodChoice seeded = choice;
        seeded.settings.set(choice.info->seed, 1000 + k);
        samples.push_back(
            figures_of(prepared, run_method(seeded, prepared.scene, prepared.facts, prepared.points, {1, 0}), exact));
    }
    for (const Light& light : lights) {
        if (!is_sampled(choice, light)) continue;
        for (auto& item : figures[light.name].items()) {
            double sum = 0, squares = 0;
            for (const Json& sample : samples) sum += sample[light.name][item.key()].get<double>();
            const double mean = sum / kRangeSeeds;
            for (const Json& sample : samples)
                squares += std::pow(sample[light.name][item.key()].get<double>() - mean, 2);
            const double width = kRangeWidth * std::sqrt(squares / (kRangeSeeds - 1));
            if (width == 0) continue;
            const bool count = item.value().is_number_integer();
            const double low = std::max(0.0, mean - width), high = mean + width;
            if (count)
                item.value() = {static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(std::ceil(high))};
            else
                item.value() = {std::stod(fmt::format("{:.3g}", low)), std::stod(fmt::format("{:.3g}", high))};
        }
    }
    return figures;
}

/// What figures.json says.
struct Figures {
    std::string machine;
    Json methods = Json::object();  ///< {method: {light: {figure: N or [low, high]}}}
};

Figures read_figures(const fs::path& file) {
    std::ifstream in(file);
    if (!in) return {};
    const Json record = Json::parse(in, nullptr, false);
    const auto wrong  = [&](bool is) {
        if (is)
            throw InputError(
                 fmt::format("{}: expected the figures of methods and lights; remove the file and run umbra accept to "
                              "write it again",
                             file.string()));
    };
    wrong(!record.is_object() || !record.contains("machine") || !record["machine"].is_string() ||
          !record.contains("methods") || !record["methods"].is_object());
    for (const auto& method : record["methods"].items()) {
        wrong(!method.value().is_object());
        for (const auto& light : method.value().items()) {
            wrong(!light.value().is_object());
            for (const auto& figure : light.value().items())
                wrong(!figure.value().is_number() && !is_range(figure.value()));
        }
    }
    return {record["machine"], record["methods"]};
}

/// A line a light, methods in the order of the report.
std::string figures_text(const Figures& figures) {
    std::string text = fmt::format("{{\n \"machine\": {},\n \"methods\": {{", Json(figures.machine).dump());
    bool first       = true;
    for (const MethodInfo* info : methods()) {
        const auto method = figures.methods.find(std::string(info->name));
        if (method == figures.methods.end()) continue;
        text += fmt::format("{}\n  \"{}\": {{", first ? "" : ",", info->name);
        for (auto light = method->begin(); light != method->end(); ++light)
            text += fmt::format("{}\n   {}: {}", light == method->begin() ? "" : ",", Json(light.key()).dump(),
                                light.value().dump());
        text += "\n  }";
        first = false;
    }
    return text + "\n }\n}\n";
}

// ---- one scene ------------------------------------------------------------------------------------------------------

/// A scene with what its goldens need, made once for all methods.
struct GoldenScene {
    PreparedScene planes, figures;
    std::optional<MethodRun> exact;  ///< of `figures`; nothing where it does not serve

    explicit GoldenScene(const fs::path& file)
        : planes(prepare_scene(file, kPlaneSize)), figures(prepare_scene(file, kFigureSize)) {
        const Reference reference = default_reference(figures.facts);
        if (reference.exact) exact = run_method(reference.choice, figures.scene, figures.facts, figures.points, {1, 0});
    }
};

/// Holds one method against its golden; renews the file and its part of `accepted` where asked.
std::optional<GoldenChange> method_change(const GoldenScene& scene, const MethodChoice& choice,
                                          const GoldenOptions& options, Figures& accepted) {
    const std::string method(choice.info->name);
    const std::string& name = scene.planes.scene.name;
    const fs::path file     = options.folder / name / (method + ".exr");
    const bool kept         = accepted.methods.contains(method) || fs::exists(file);
    GoldenChange change;
    change.name = fmt::format("{}/{}", name, method);

    const MethodRun run = run_method(choice, scene.planes.scene, scene.planes.facts, scene.planes.points, {1, 0});
    if (!run.service) {
        if (!kept) return std::nullopt;
        change.kind  = GoldenChange::Kind::removed;
        change.lines = {"the method does not serve the scene: " + run.service.why};
        if (options.renew) {
            fs::remove(file);
            accepted.methods.erase(method);
        }
        return change;
    }

    const Image before = fs::exists(file) ? read_image(file).image : Image(kPlaneSize.width, kPlaneSize.height, {});
    const Image now    = coded(scene.planes, run);
    Changes changes    = plane_changes(before, now, scene.planes);
    const std::size_t plane_lines = changes.lines.size();

    Json figures = Json::object();
    if (scene.exact)
        figures = figures_of(scene.figures,
                             run_method(choice, scene.figures.scene, scene.figures.facts, scene.figures.points, {1, 0}),
                             *scene.exact);
    add_figure_changes(accepted.methods.value(method, Json::object()), figures, changes);
    if (changes.lines.empty()) return std::nullopt;

    change.kind     = kept ? GoldenChange::Kind::changed : GoldenChange::Kind::added;
    change.rounding = kept && changes.at_edges_alone && accepted.machine != rounding_machine();
    if (!options.pictures.empty() && !changes.planes.empty()) {
        change.pictures = options.pictures / fmt::format("{}.{}", name, method);
        leave_pictures(change.pictures, scene.planes, before, now, changes.planes);
    }
    if (options.renew && plane_lines > 0) {
        fs::create_directories(file.parent_path());
        if (now.channels.empty())
            fs::remove(file);
        else
            write_image(file, now);
    }
    if (options.renew && changes.lines.size() > plane_lines) {
        if (scene.exact)
            accepted.methods[method] = with_ranges(std::move(figures), scene.figures, choice, *scene.exact);
        else
            accepted.methods.erase(method);
    }
    change.lines = std::move(changes.lines);
    return change;
}

/// Goldens of methods that are no longer there.
std::vector<GoldenChange> method_leftovers(const std::string& scene, const GoldenOptions& options,
                                           const Figures& accepted) {
    std::set<std::string> names;
    for (const auto& item : accepted.methods.items()) names.insert(item.key());
    if (fs::exists(options.folder / scene))
        for (const auto& entry : fs::directory_iterator(options.folder / scene))
            if (entry.path().extension() == ".exr") names.insert(entry.path().stem().string());
    for (const MethodInfo* info : methods()) names.erase(std::string(info->name));
    std::vector<GoldenChange> changes;
    for (const std::string& name : names) {
        GoldenChange change;
        change.name  = fmt::format("{}/{}", scene, name);
        change.kind  = GoldenChange::Kind::removed;
        change.lines = {"unknown method"};
        changes.push_back(std::move(change));
        if (options.renew) fs::remove(options.folder / scene / (name + ".exr"));
    }
    return changes;
}

}  // namespace

std::string_view to_string(GoldenChange::Kind kind) {
    switch (kind) {
        case GoldenChange::Kind::changed: return "changed";
        case GoldenChange::Kind::added: return "new";
        case GoldenChange::Kind::removed: return "removed";
    }
    return "";
}

std::string rounding_machine() {
    const Json machine = machine_json(1);
#if defined(__x86_64__)
    const bool fused = __builtin_cpu_supports("fma") != 0;
#else
    const bool fused = true;
#endif
    return fmt::format("{}, {}, {}", machine["system"].get<std::string>(), machine["compiler"].get<std::string>(),
                       fused ? "fused multiply and add" : "no fused multiply and add");
}

bool is_sampled(const MethodChoice& choice, const Light& light) {
    const auto is_seed = [](const Parameter& p) { return p.name == "seed"; };
    return is_area(light.kind) && std::any_of(choice.info->parameters.begin(), choice.info->parameters.end(), is_seed);
}

std::vector<GoldenChange> golden_changes(const fs::path& file, const GoldenOptions& options) {
    const std::string name = file.stem().string();
    std::vector<MethodChoice> choices;
    for (const MethodInfo* info : methods())
        if (info->by_default && wanted(options, name, info->name)) choices.emplace_back(*info);
    if (choices.empty()) return {};

    const fs::path figures_file = options.folder / name / "figures.json";
    Figures accepted            = read_figures(figures_file);
    std::vector<GoldenChange> changes;
    const bool all = choices.size() == std::size_t(std::ranges::count_if(methods(), &MethodInfo::by_default));
    if (all) changes = method_leftovers(name, options, accepted);
    const GoldenScene scene(file);
    for (const MethodChoice& choice : choices)
        if (auto change = method_change(scene, choice, options, accepted)) changes.push_back(std::move(*change));
    if (!options.renew || changes.empty()) return changes;

    accepted.machine = rounding_machine();
    StagedFiles staged;
    staged.write(figures_file, figures_text(accepted));
    staged.commit();
    return changes;
}

std::vector<GoldenChange> golden_leftovers(const std::vector<fs::path>& scenes, const GoldenOptions& options) {
    std::vector<GoldenChange> changes;
    if (!options.names.empty() || !fs::exists(options.folder)) return changes;
    for (const auto& entry : fs::directory_iterator(options.folder)) {
        const std::string name = entry.path().filename().string();
        const bool known =
            std::any_of(scenes.begin(), scenes.end(), [&](const fs::path& scene) { return scene.stem() == name; });
        if (known || !entry.is_directory()) continue;
        GoldenChange change;
        change.name  = name;
        change.kind  = GoldenChange::Kind::removed;
        change.lines = {"unknown teaching scene"};
        changes.push_back(std::move(change));
        if (options.renew) fs::remove_all(entry.path());
    }
    return changes;
}

void check_golden_names(const std::vector<fs::path>& scenes, const GoldenOptions& options) {
    for (const std::string& name : options.names) {
        const bool known = std::any_of(scenes.begin(), scenes.end(), [&](const fs::path& scene) {
            return std::any_of(methods().begin(), methods().end(), [&](const MethodInfo* info) {
                return wanted({.names = {name}}, scene.stem().string(), info->name);
            });
        });
        if (known) continue;
        std::vector<std::string> there;
        for (const fs::path& scene : scenes) there.push_back(scene.stem().string());
        for (const MethodInfo* info : methods()) there.emplace_back(info->name);
        throw UsageError(fmt::format("unknown golden \"{}\", expected SCENE, METHOD or SCENE/METHOD of {}", name,
                                     fmt::join(there, ", ")));
    }
}

}  // namespace umbra
