#include "umbra/bench/contenders/truth_set.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/npy.h"
#include "umbra/bench/base/scene_files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/core/base/error.h"
#include "umbra/core/errors/error_classes.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

std::string sha256(const std::string& bytes) {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int length = 0;
    if (EVP_Digest(bytes.data(), bytes.size(), digest, &length, EVP_sha256(), nullptr) != 1)
        throw std::runtime_error("no SHA-256 can be computed");
    std::string text;
    for (unsigned int k = 0; k < length; ++k) text += fmt::format("{:02x}", digest[k]);
    return text;
}

/// Planes of all lights behind one another, as files have them.
struct Answered {
    std::vector<float> s, half_width;
    std::vector<std::uint8_t> edge, boundary;
};

Answered answered(const PreparedScene& prepared, const Reference& reference) {
    const PointBatch& points = prepared.points;
    const ReferenceRun ran =
        run_reference(reference, prepared.scene, prepared.facts, points, static_cast<std::uint64_t>(points.size()));
    Answered all;
    for (LightId j = 0; j < prepared.scene.lights.size(); ++j) {
        const VisibilityPlane& plane = ran.run.planes[j];
        const auto band              = edge_band(points, j, plane, visibility_tolerance(prepared.scene.lights[j].kind));
        all.edge.insert(all.edge.end(), band.begin(), band.end());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const bool told = points.asks(j, i) && plane.defined(i);
            all.s.push_back(told ? plane.s[i] : std::nanf(""));
            all.half_width.push_back(told ? plane.half_width[i] : 0);
            all.boundary.push_back(points.asks(j, i) && plane.answer[i] == Answer::on_boundary ? 1 : 0);
        }
    }
    return all;
}

void add_file(TruthSceneRecord& scene, const fs::path& file) {
    const std::string bytes = bytes_of(file);
    scene.files.push_back({file.filename().string(), sha256(bytes), bytes.size()});
}

TruthSceneRecord write_scene(const ChosenScene& chosen, const TruthOrder& order, const fs::path& questions,
                             const fs::path& answers) {
    const PreparedScene prepared = prepare_scene(chosen.file, order.size);
    const Scene& scene           = prepared.scene;
    const auto w                 = static_cast<std::size_t>(prepared.points.raster->width),
               h = static_cast<std::size_t>(prepared.points.raster->height), lights = scene.lights.size();
    const Shape shape{lights, h, w};
    const Reference reference = default_reference(prepared.facts);
    TruthSceneRecord record{.folder    = chosen.folder,
                            .title     = scene.title,
                            .shows     = scene.shows,
                            .reference = reference.choice.text(),
                            .exact     = reference.exact,
                            .width     = w,
                            .height    = h,
                            .measures  = {"area"}};
    make_folder(questions), make_folder(answers);
    write_scene_files(questions, scene);
    write_points(questions / "points.npy", scene, prepared.points);
    std::vector<std::uint8_t> asked;
    for (LightId j = 0; j < lights; ++j)
        for (std::size_t i = 0; i < prepared.points.size(); ++i) {
            asked.push_back(prepared.points.asks(j, i) ? 1 : 0);
            record.asked += asked.back();
        }
    write_npy(questions / "asked.npy", asked, shape);
    for (const char* name : {SceneExport::json, SceneExport::glb, SceneExport::triangles, SceneExport::object,
                             SceneExport::blocks, "points.npy", "asked.npy"})
        add_file(record, questions / name);
    for (const Light& light : scene.lights)
        record.lights.push_back(
            {light.name, std::string(to_string(light.kind)), static_cast<double>(visibility_tolerance(light.kind))});
    if (!prepared.facts.hard_lights_only) record.measures.emplace_back("irradiance");
    for (const std::string& measure : record.measures) {
        if (order.progress) order.progress(fmt::format("{}: {}", chosen.name, measure));
        const Reference of = measure == "area" ? reference : default_reference(prepared.facts, Measure::irradiance);
        record.exact       = record.exact && of.exact;
        const Answered all = answered(prepared, of);
        const auto write   = [&](const std::string& name, const auto& values) {
            const fs::path file = answers / fmt::format("{}{}.npy", measure, name);
            write_npy(file, values, shape);
            add_file(record, file);
        };
        write("", all.s);
        write("_half_width", all.half_width);
        write("_edge", all.edge);
        write("_boundary", all.boundary);
    }
    return record;
}

/// Croissant 1.0 (mlcommons.org): what data-set search engines read.
Json croissant(const TruthSetRecord& set) {
    Json files = Json::array();
    for (const TruthSceneRecord& scene : set.scenes)
        for (const TruthFileRecord& file : scene.files)
            files.push_back({{"@type", "cr:FileObject"},
                             {"@id", scene.folder + "/" + file.name},
                             {"name", file.name},
                             {"contentUrl", scene.folder + "/" + file.name},
                             {"contentSize", fmt::format("{} B", file.bytes)},
                             {"encodingFormat", file.name.ends_with(".npy")   ? "application/x-npy"
                                                : file.name.ends_with(".glb") ? "model/gltf-binary"
                                                                              : "application/json"},
                             {"sha256", file.sha256}});
    return {{"@context",
             {{"@vocab", "https://schema.org/"},
              {"cr", "http://mlcommons.org/croissant/"},
              {"dct", "http://purl.org/dc/terms/"},
              {"sc", "https://schema.org/"},
              {"conformsTo", "dct:conformsTo"}}},
            {"@type", "sc:Dataset"},
            {"conformsTo", "http://mlcommons.org/croissant/1.0"},
            {"name", "umbra-truth"},
            {"description",
             "Which fraction of each light each visible surface point of a scene sees, with bounds on the "
             "error: the truth that shadow algorithms are judged by."},
            {"license", set.license},
            {"version", set.head.version},
            {"distribution", files}};
}

TruthSetRecord without_answers(TruthSetRecord set) {
    set.withheld = true;
    for (TruthSceneRecord& scene : set.scenes)
        std::erase_if(scene.files, [](const TruthFileRecord& file) {
            return file.name.starts_with("area") || file.name.starts_with("irradiance");
        });
    return set;
}

void write_records(const fs::path& folder, TruthSetRecord set) {
    set.files = {"croissant.json"};
    write_text(folder / "croissant.json", json_text(croissant(set)));
    write_text(folder / "results.json", json_text(to_record(set)));
}

/// A set may have come from anywhere. Throws InputError where a member cannot be what `umbra truth` writes.
void check_scene(const TruthSceneRecord& scene, const std::string& where) {
    if (const fs::path folder = scene.folder; folder.filename() != folder || folder == ".." || folder == ".")
        throw InputError(fmt::format("{}: folder {:?} is none beside results.json", where, scene.folder));
    if (scene.lights.empty()) throw InputError(fmt::format("{}: has no lights", where));
    for (const TruthLightRecord& light : scene.lights)
        if (!(light.tolerance >= 0 && light.tolerance <= 1))
            throw InputError(
                fmt::format("{}: tolerance of {:?} is {}, expected 0 to 1", where, light.name, light.tolerance));
}

/// One array of a scene of the set, of lights x height x width, whose bytes have the checksum of the record.
std::vector<float> array_of(const fs::path& set, const TruthSceneRecord& scene, const std::string& name) {
    const fs::path file = set / scene.folder / name;
    const auto known    = std::ranges::find(scene.files, name, &TruthFileRecord::name);
    if (known == scene.files.end())
        throw InputError(fmt::format("{}: is not part of the set: are the answers withheld?", file.string()));
    if (sha256(bytes_of(file)) != known->sha256)
        throw InputError(fmt::format("{}: differs from its checksum in results.json", file.string()));
    Numbers numbers = read_npy(file);
    if (numbers.shape != Shape{scene.lights.size(), scene.height, scene.width})
        throw InputError(fmt::format("{}: holds {} values, expected {} x {} x {}", file.string(),
                                     in_words(numbers.shape), scene.lights.size(), scene.height, scene.width));
    return std::move(numbers.values);
}

std::vector<float> answers_of(const NamedAnswers& answering, const TruthSceneRecord& scene, std::size_t scenes) {
    const bool one      = scenes == 1 && fs::is_regular_file(answering.where);
    const fs::path file = one ? answering.where : answering.where / (scene.folder + ".npy");
    Numbers numbers     = read_npy(file);
    const std::size_t n = scene.lights.size() * scene.height * scene.width;
    Shape shape         = numbers.shape;
    if (shape.size() == 2 && scene.lights.size() == 1) shape.insert(shape.begin(), 1);
    if (shape != Shape{scene.lights.size(), scene.height, scene.width} || numbers.values.size() != n)
        throw InputError(fmt::format("{}: holds {} values, expected {} (lights) x {} x {}", file.string(),
                                     in_words(numbers.shape), scene.lights.size(), scene.height, scene.width));
    for (std::size_t i = 0; i < n; ++i)
        if (numbers.values[i] < -kAnswerSlack || numbers.values[i] > 1 + kAnswerSlack)
            throw InputError(fmt::format("{}: value {} is {}, expected 0 (in shadow) to 1 (lit), or NaN for undefined",
                                         file.string(), i, numbers.values[i]));
    return std::move(numbers.values);
}

}  // namespace

TruthSetRecord write_truth(const TruthOrder& order) {
    const std::vector<ChosenScene> scenes = chosen_scenes(order.scenes);
    StagedFolder stage(order.out);
    std::optional<StagedFolder> held;
    if (!order.withhold.empty()) held.emplace(order.withhold);
    TruthSetRecord set{.head = head_record(order.command), .license = order.license};
    for (const ChosenScene& scene : scenes) {
        const fs::path questions = stage.folder() / scene.folder;
        const fs::path answers   = held ? held->folder() / scene.folder : questions;
        set.scenes.push_back(write_scene(scene, order, questions, answers));
        if (held)  // whoever scores needs the questions' files no more, but `asked`
            fs::copy_file(questions / "asked.npy", answers / "asked.npy");
    }
    write_records(stage.folder(), held ? without_answers(set) : set);
    if (held) {
        TruthSetRecord answers = set;
        for (TruthSceneRecord& scene : answers.scenes)
            std::erase_if(scene.files, [&](const TruthFileRecord& file) {
                return !fs::exists(held->folder() / scene.folder / file.name);
            });
        write_records(held->folder(), answers);
        held->commit();
    }
    stage.commit();
    return set;
}

std::vector<ScoreRecord> score(const fs::path& set, std::span<const NamedAnswers> answers) {
    const auto record = from_record<TruthSetRecord>(read_results(set / "results.json"));
    if (record.scenes.empty())
        throw InputError(
            fmt::format("{}: has no scenes: it is no set that `umbra truth` wrote", (set / "results.json").string()));
    for (std::size_t k = 0; k < record.scenes.size(); ++k)
        check_scene(record.scenes[k], fmt::format("{}: /scenes/{}", (set / "results.json").string(), k));
    std::vector<ScoreRecord> scores;
    for (const NamedAnswers& answering : answers)
        for (const TruthSceneRecord& scene : record.scenes) {
            // Lights without an area have one truth, whatever is measured.
            const bool both           = scene.measures.size() > 1;
            const std::string measure = both ? std::string(to_string(answering.measure)) : "area";
            const auto truth          = array_of(set, scene, measure + ".npy"),
                       half           = array_of(set, scene, measure + "_half_width.npy"),
                       edge           = array_of(set, scene, measure + "_edge.npy"),
                       boundary       = array_of(set, scene, measure + "_boundary.npy"),
                       asked          = array_of(set, scene, "asked.npy");
            const auto s              = answers_of(answering, scene, record.scenes.size());
            const std::size_t n       = scene.width * scene.height;
            for (std::size_t j = 0; j < scene.lights.size(); ++j) {
                ScoreRecord of{.contender = answering.name,
                               .scene     = scene.folder,
                               .light     = scene.lights[j].name,
                               .measure   = measure};
                double sum = 0, absolute = 0, square = 0, most = 0;
                for (std::size_t i = j * n; i < (j + 1) * n; ++i) {
                    if (asked[i] == 0 || std::isnan(truth[i])) continue;
                    if (boundary[i] != 0) {
                        ++of.boundary;
                        continue;
                    }
                    if (std::isnan(s[i])) {
                        ++of.undefined;
                        continue;
                    }
                    ++of.points;
                    const double difference = static_cast<double>(s[i]) - static_cast<double>(truth[i]);
                    sum += difference, absolute += std::abs(difference), square += difference * difference;
                    most = std::max(most, std::abs(difference));
                    if (std::abs(difference) <= scene.lights[j].tolerance + static_cast<double>(half[i])) continue;
                    ++(edge[i] != 0 ? of.edge : difference < 0 ? of.false_shadow : of.false_light);
                }
                if (of.points > 0) {
                    const auto points = static_cast<double>(of.points);
                    of.mae = absolute / points, of.rmse = std::sqrt(square / points), of.bias = sum / points,
                    of.max = most;
                }
                scores.push_back(of);
            }
        }
    return scores;
}

}  // namespace umbra
