#include "umbra/bench/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <set>

#include "umbra/bench/compare/pictures.h"
#include "umbra/bench/out/staged_folder.h"
#include "umbra/bench/run/explain.h"
#include "umbra/bench/run/noise_runs.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr long kMaxArea = 1L << 26;

template <class Work>
double timed_ms(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// One method's S_j planes made into pictures, once.
struct Rendered {
    Image linear;  ///< R G B
    Image shown;   ///< R G B, sRGB
};

Rendered render(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> planes) {
    Rendered r;
    r.linear = shade(scene, points, planes);
    r.shown  = displayed(r.linear, scene.tone, scene.exposure);
    return r;
}

std::map<std::string, std::string> metadata(const Scene& scene, const MethodChoice& choice,
                                            const std::string& command) {
    return {{"umbra:scene", scene.source},
            {"umbra:method", std::string(choice.info->name)},
            {"umbra:parameters", choice.text()},
            {"umbra:version", std::string(version())},
            {"umbra:command", command}};
}

Json parameters_json(const Settings& settings) {
    Json values = Json::object();
    for (const Parameter& p : settings.parameters())
        values[std::string(p.name)] = setting_json(p, settings.value(p.name));
    return values;
}

/// Writes one method's files into `folder` and returns their names. `explained` is one a light, or empty where there is
/// nothing to differ from.
Json write_files(const fs::path& folder, const std::string& id, const PreparedScene& prepared, const MethodRun& run,
                 const Rendered& rendered, const MethodRun& reference, std::span<const Explained> explained,
                 const std::string& command) {
    const Scene& scene       = prepared.scene;
    const PointBatch& points = prepared.points;
    Json files               = {{"exr", id + ".exr"}, {"png", id + ".png"}, {"lights", Json::object()}};

    Image full    = with_planes(rendered.linear, scene, points, run.planes, explained.empty());
    full.metadata = metadata(scene, run.choice, command);
    write_image(folder / (id + ".exr"), full);
    write_image(folder / (id + ".png"), rendered.shown);
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        const std::string& light = scene.lights[j].name;
        Json entry               = {{"visibility", fmt::format("{}.S.{}.png", id, light)}};
        write_image(folder / entry["visibility"], visibility_picture(points, run.planes[j]));
        if (!explained.empty()) {
            entry["difference"] = fmt::format("{}.diff.{}.png", id, light);
            write_image(folder / entry["difference"],
                        difference_picture(points, j, run.planes[j], reference.planes[j]));
            entry["classes"] = fmt::format("{}.classes.{}.png", id, light);
            write_image(folder / entry["classes"], class_picture(points, explained[j].classes, reference.planes[j]));
        }
        files["lights"][light] = std::move(entry);
    }
    return files;
}

Json displacement_json(const std::optional<EdgeDisplacement>& d) {
    if (!d) return {};
    return {{"mean", number(d->mean)},
            {"p95", number(d->p95)},
            {"max", number(d->max)},
            {"pieces", d->pieces},
            {"unmatched", d->unmatched}};
}

Json penumbra_json(const std::optional<PenumbraWidth>& w) {
    if (!w) return {};
    return {{"method", number(w->method)}, {"reference", number(w->reference)}};
}

Json noise_json(const std::optional<Noise>& n) {
    if (!n) return {};
    return {{"runs", n->runs}, {"noise_rmse", number(n->rms)}, {"bias_rmse", number(n->bias)}};
}

Json direction_json(const VisibilityError::Direction& d) {
    return {{"false_shadow", d.false_shadow}, {"false_light", d.false_light}};
}

Json error_json(const std::string& light, const Explained& explained) {
    const VisibilityError& e = explained.error;
    // Detachment and leak are told apart by the occluder: null where the reference names none.
    const bool named = e.unnamed == 0;
    return {{"light", light},
            {"points", e.points},
            {"undefined", e.undefined},
            {"away", e.away},
            {"on_boundary", e.on_boundary},
            {"not_judged", e.not_judged},
            {"lit", e.lit},
            {"umbra", e.umbra},
            {"penumbra", e.penumbra},
            {"false_shadow", {{"interior", e.false_shadow.interior}, {"edge", e.false_shadow.edge}, {"acne", e.acne}}},
            {"false_light",
             {{"interior", e.false_light.interior},
              {"edge", e.false_light.edge},
              {"detachment", named ? Json(e.detachment) : Json()},
              {"leak", named ? Json(e.leak) : Json()}}},
            {"interior", {{"lit", e.interior.lit}, {"umbra", e.interior.umbra}, {"penumbra", e.interior.penumbra}}},
            {"penumbra_error", direction_json(e.penumbra_error)},
            {"noise_error", direction_json(e.noise_error)},
            {"terminator",
             {{"facet_away", e.terminator.facet_away},
              {"normal_away", e.terminator.normal_away},
              {"wrong", e.terminator.wrong}}},
            {"bracket", e.max_half_width > 0 ? Json{{"max_half_width", number(e.max_half_width)}} : Json()},
            {"mae", number(e.mae)},
            {"rmse", number(e.rmse)},
            {"max", number(e.max)},
            {"bias", number(e.bias)},
            {"noise", noise_json(explained.noise)},
            {"edge_displacement_px", displacement_json(explained.displacement)},
            {"penumbra_width_px", penumbra_json(explained.penumbra_width)}};
}

Json judged_json(const ReferenceRun& reference) {
    if (reference.stand_in.empty()) return nullptr;
    return {{"points", reference.judged}, {"of", reference.of}, {"guess", reference.stand_in}};
}

/// Differences of the pictures over covered pixels: where a method leaves any light undefined, the reference's pixel
/// stands in.
Json image_json(const fs::path& folder, const std::string& id, const MethodRun& run, Rendered rendered,
                const Rendered& reference, Json& files) {
    for (const VisibilityPlane& plane : run.planes)
        for (std::size_t i = 0; i < plane.size(); ++i)
            if (!plane.defined(i))
                for (std::size_t c = 0; c < 3; ++c) {
                    rendered.linear.at(i, c) = reference.linear.at(i, c);
                    rendered.shown.at(i, c)  = reference.shown.at(i, c);
                }
    const Flip flip = flip_ldr(reference.shown, rendered.shown);
    files["flip"]   = id + ".flip.png";
    write_image(folder / files["flip"], flip_picture(rendered.shown.width, rendered.shown.height, flip.map));
    return {{"rmse", number(image_error(rendered.linear, reference.linear).rmse)},
            {"psnr", number(image_error(rendered.shown, reference.shown).psnr)},
            {"ssim", number(ssim(rendered.shown, reference.shown))},
            {"flip", number(flip.mean)},
            {"flip_hdr", number(flip_hdr(reference.linear, rendered.linear).mean)}};
}

/// "name", then "name-2", ...: ids name files and must not repeat.
std::string unique_id(std::string_view name, std::set<std::string>& used) {
    std::string id(name);
    for (int k = 2; !used.insert(id).second; ++k) id = fmt::format("{}-{}", name, k);
    return id;
}

Json method_entry(const fs::path& folder, const std::string& id, const PreparedScene& prepared, const MethodRun& run,
                  const MethodRun& reference, const Rendered& reference_rendered, const std::string& command,
                  double& shade_ms) {
    const MethodInfo& info = *run.choice.info;
    Json entry             = {{"id", id},
                              {"name", info.name},
                              {"title", info.title},
                              {"paper", info.paper},
                              {"summary", info.summary},
                              {"text", run.choice.text()},
                              {"parameters", parameters_json(run.choice.settings)},
                              {"serves", service_json(run.service)}};
    if (!run.service) return entry;

    const Scene& scene = prepared.scene;
    Json light_times = Json::array(), errors = Json::array();
    std::vector<Explained> explained;
    const auto noise = noise_runs(run.choice, scene, prepared.facts, prepared.points);
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        const Light& light = scene.lights[j];
        light_times.push_back({{"light", light.name},
                               {"aim_ms", timing_json(run.aim[j])},
                               {"visibility_ms", timing_json(run.visibility[j])}});
        explained.push_back(explain(scene, prepared.points, j, run, reference, noise[j] ? &*noise[j] : nullptr));
        errors.push_back(error_json(light.name, explained.back()));
    }
    entry["times"]        = {{"build_ms", timing_json(run.build)},
                             {"aim_ms", timing_json(total(run.aim))},
                             {"visibility_ms", timing_json(total(run.visibility))}};
    entry["light_times"]  = std::move(light_times);
    entry["memory_bytes"] = run.memory_bytes;
    entry["coverage"]     = run.coverage(prepared.points);
    entry["errors"]       = std::move(errors);

    Rendered rendered;
    shade_ms       = timed_ms([&] { rendered = render(scene, prepared.points, run.planes); });
    Json files     = write_files(folder, id, prepared, run, rendered, reference, explained, command);
    entry["image"] = image_json(folder, id, run, std::move(rendered), reference_rendered, files);
    entry["files"] = std::move(files);
    return entry;
}

/// The record with every file name set behind `prefix`.
Json with_prefix(Json record, const std::string& prefix) {
    const auto visit = [&](auto&& self, Json& node) -> void {
        for (auto& item : node.items()) {
            if (item.value().is_string())
                item.value() = prefix + item.value().get<std::string>();
            else
                self(self, item.value());
        }
    };
    if (record["reference"].contains("files")) visit(visit, record["reference"]["files"]);
    for (Json& method : record["methods"])
        if (method.contains("files")) visit(visit, method["files"]);
    return record;
}

}  // namespace

Size parse_size(const std::string& text) {
    Size size;
    const std::size_t cross = text.find('x');
    const auto read         = [&](std::size_t begin, std::size_t end, int& value) {
        const auto [at, error] = std::from_chars(text.data() + begin, text.data() + end, value);
        return error == std::errc() && at == text.data() + end && value >= 1 && value <= kMaxPictureSide;
    };
    if (cross == std::string::npos || !read(0, cross, size.width) || !read(cross + 1, text.size(), size.height) ||
        static_cast<long>(size.width) * size.height > kMaxArea)
        throw UsageError(fmt::format("--size {}: not a size (write WIDTHxHEIGHT, each 1 to {}, at most {} pixels)",
                                     text, kMaxPictureSide, kMaxArea));
    return size;
}

PreparedScene prepare_scene(const fs::path& file, Size size) {
    PreparedScene p;
    p.load_ms  = timed_ms([&] { p.scene = load_scene(file); });
    p.facts_ms = timed_ms([&] { p.facts = find_facts(p.scene); });
    if (size.width == 0) size = {p.scene.width, p.scene.height};
    std::optional<RayScene> rays;
    p.rays_build_ms = timed_ms([&] { rays.emplace(p.scene); });
    p.gbuffer_ms =
        timed_ms([&] { p.points = primary_points(*rays, p.scene, p.scene.camera, size.width, size.height); });
    return p;
}

Json compare_scene(const fs::path& file, const CompareOptions& options) {
    const auto tell = [&](const std::string& what) {
        if (options.progress) options.progress(fmt::format("{}: {}", file.stem().string(), what));
    };
    std::vector<MethodChoice> choices;
    for (const std::string& text : options.methods) choices.push_back(parse_method(text));
    if (options.methods.empty())
        for (const MethodInfo* info : methods())
            if (info->by_default) choices.emplace_back(*info);

    tell("loading");
    const PreparedScene prepared = prepare_scene(file, options.size);
    const Scene& scene           = prepared.scene;

    const fs::path folder = options.out / scene.name;
    StagedFolder stage(folder);
    const fs::path& staging = stage.folder();

    Reference reference = default_reference(prepared.facts);
    if (options.reference) {
        reference       = {parse_method(*options.reference), false, "Chosen on the command line."};
        reference.exact = reference.choice.info->reference;
    }
    tell("reference " + reference.choice.text());
    const ReferenceRun reference_ran = run_reference(reference, scene, prepared.facts, prepared.points, options.points);
    const MethodRun& reference_run   = reference_ran.run;
    const Rendered reference_rendered = render(scene, prepared.points, reference_run.planes);

    Json record = {{"schema", kResultsSchema},
                   {"version", version()},
                   {"command", options.command},
                   {"machine", machine_json(options.threads)},
                   {"scene", scene_json(scene)},
                   {"facts", facts_json(prepared.facts)},
                   {"size", {{"width", prepared.points.raster->width}, {"height", prepared.points.raster->height}}},
                   {"lights", lights_json(prepared.facts)},
                   {"times", Json::object()},
                   {"reference",
                    {{"name", reference.choice.info->name},
                     {"title", reference.choice.info->title},
                     {"text", reference.choice.text()},
                     {"parameters", parameters_json(reference.choice.settings)},
                     {"exact", reference.exact},
                     {"note", reference.note},
                     {"judged", judged_json(reference_ran)},
                     {"times",
                      {{"build_ms", timing_json(reference_run.build)},
                       {"aim_ms", timing_json(total(reference_run.aim))},
                       {"visibility_ms", timing_json(total(reference_run.visibility))}}},
                     {"files", write_files(staging, "reference", prepared, reference_run, reference_rendered,
                                           reference_run, {}, options.command)}}},
                   {"methods", Json::array()}};

    std::set<std::string> used = {"reference"};
    double shade_ms            = 0;
    for (const MethodChoice& choice : choices) {
        // Where the whole picture is too dear for the reference, it is so for the same method in the list, too.
        const bool itself = choice.text() == reference.choice.text();
        if (itself && options.methods.empty() && !reference_ran.stand_in.empty()) continue;
        tell(choice.text());
        const bool slow     = total(reference_run.visibility).median > options.repeats.budget_ms;
        const MethodRun run = itself && slow && reference_ran.stand_in.empty()
                                  ? reference_run
                                  : run_method(choice, scene, prepared.facts, prepared.points, options.repeats);
        record["methods"].push_back(method_entry(staging, unique_id(choice.info->name, used), prepared, run,
                                                 reference_run, reference_rendered, options.command, shade_ms));
    }
    record["times"] = {{"load_ms", prepared.load_ms},
                       {"facts_ms", prepared.facts_ms},
                       {"rays_build_ms", prepared.rays_build_ms},
                       {"gbuffer_ms", prepared.gbuffer_ms},
                       {"shade_ms", shade_ms}};
    write_text(staging / "results.json", record.dump(1) + "\n");
    stage.commit();
    return record;
}

ScenesDone compare_scenes(const std::vector<fs::path>& files, const CompareOptions& options) {
    std::set<std::string> stems;
    for (const fs::path& file : files)
        if (!stems.insert(file.stem().string()).second)
            throw UsageError(
                fmt::format("two scenes are called \"{}\": their results would share a folder (compare them with "
                            "different -o)",
                            file.stem().string()));
    ScenesDone done;
    Json last;
    for (const fs::path& file : files) {
        try {
            last = compare_scene(file, options);
            done.names.push_back(last["scene"]["name"]);
        } catch (const MissingMesh& e) {
            done.missing.emplace_back(e.what());
        } catch (const InputError& e) {
            done.failed.emplace_back(e.what());
        }
    }
    if (files.size() == 1 && done.names.size() == 1)
        write_text(options.out / "results.json", with_prefix(last, done.names[0] + "/").dump(1) + "\n");
    return done;
}

Service render_scene(const fs::path& file, const RenderOptions& options) {
    const MethodChoice choice    = parse_method(options.method);
    const PreparedScene prepared = prepare_scene(file, options.size);
    const MethodRun run          = run_method(choice, prepared.scene, prepared.facts, prepared.points, {1, 0});
    if (!run.service) return run.service;
    const Rendered rendered = render(prepared.scene, prepared.points, run.planes);
    Image image             = options.out.extension() == ".png" ? rendered.shown
                                                                : with_planes(rendered.linear, prepared.scene, prepared.points,
                                                                              run.planes, options.with_geometry);
    image.metadata          = metadata(prepared.scene, choice, options.command);
    write_image(options.out, image);
    return run.service;
}

}  // namespace umbra
