#include "umbra/bench/studies/energy/energy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "umbra/bench/base/files.h"
#include "umbra/bench/lab/asked_method.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/sampling.h"
#include "umbra/core/render/sum.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

double luminance(const dvec3& colour) { return glm::dot(colour, dvec3(0.2126, 0.7152, 0.0722)); }

constexpr std::array kSides{FaceSide::winding, FaceSide::other};
constexpr const char* kColumns =
    "area,irradiance,unshadowed,coverage,irradiance_r,irradiance_g,irradiance_b,back_irradiance,back_unshadowed,"
    "back_coverage\n";
constexpr const char* kUnit =
    "that of the lights, by luminance: lx for intensities in candelas, lengths in metres and photometric attenuation";

bool has_side(const Scene& scene, const SceneFacts& facts, TriangleId t, FaceSide side) {
    const auto o                = scene.triangle_object[t];
    const ObjectFacts& facts_of = facts.objects[o];
    return side == FaceSide::winding ||
           (scene.materials[scene.objects[o].material].two_sided && !(facts_of.closed && facts_of.outward));
}

/// Points of every triangle that has an area, and where those of each begin; one entry more than triangles.
struct FacePoints {
    PointBatch points;
    std::vector<std::size_t> first;
};

/// Points [begin, end) of the batch, evenly spread over a side of triangle t.
void spread_on(const Scene& scene, TriangleId t, FaceSide side, std::size_t begin, std::size_t end,
               PointBatch& points) {
    const std::uint8_t flipped = side == FaceSide::other ? 1 : 0;
    const SampleSet set(Sampler::r2, static_cast<int>(end - begin), 0);
    Samples8 eight;
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t k = (i - begin) % 8;
        if (k == 0) set.eight(set.key(t), static_cast<int>(i - begin), eight);
        const bool outside = eight.x[k] + eight.y[k] > 1;  // the other half of the square
        set_point(points, i, scene, t, outside ? 1 - eight.x[k] : eight.x[k], outside ? 1 - eight.y[k] : eight.y[k]);
        if (points.flipped[i] == flipped) continue;  // two-sided materials turn to the eye
        points.nx[i] = -points.nx[i], points.ny[i] = -points.ny[i], points.nz[i] = -points.nz[i];
        points.flipped[i] = flipped;
    }
}

FacePoints spread_points(const Scene& scene, const std::vector<double>& areas, FaceSide side, std::uint64_t wanted) {
    double all = 0;
    for (const double area : areas) all += area;
    FacePoints spread;
    spread.first.push_back(0);
    for (const double area : areas) {
        const double share = all > 0 ? area / all * static_cast<double>(wanted) : 0;
        spread.first.push_back(spread.first.back() +
                               (area > 0 ? std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share))) : 0));
    }
    PointBatch& points = spread.points;
    points.resize(spread.first.back());
    for (TriangleId t = 0; t < areas.size(); ++t)
        if (spread.first[t] < spread.first[t + 1])
            spread_on(scene, t, side, spread.first[t], spread.first[t + 1], points);
    face_lights(points, scene);
    return spread;
}

/// f_att I_j max(N.L, 0) of light j at point i, by channel.
dvec3 arriving(const Scene& scene, const PointBatch& points, LightId j, std::size_t i) {
    const Light& light  = scene.lights[j];
    const vec3 p        = points.position(i);
    const double cosine = glm::dot(dvec3(points.normal(i)), dvec3(to_light(light, p).direction));
    if (!(cosine > 0) || !lights_object(light, scene.objects[scene.triangle_object[points.triangle[i]]].name))
        return dvec3(0);
    return dvec3(light.diffuse) * arriving_share(scene, light, p) * cosine;
}

/// What follows from the sums; nothing where the method answers no point that a light reaches.
Json energy_json(const ReceivedEnergy& e) {
    return {
        {"area", number(e.area)},
        {"irradiance", e.answered() ? number(e.irradiance) : Json()},
        {"irradiance_rgb", e.answered() ? Json{number(e.colour.x), number(e.colour.y), number(e.colour.z)} : Json()},
        {"unshadowed", e.answered() ? number(e.unshadowed) : Json()},
        {"fraction", e.unshadowed > 0 ? number(e.irradiance / e.unshadowed) : Json()},
        {"coverage", e.asked > 0 ? number(e.unshadowed / e.asked) : Json()}};
}

/// Both sides of an object.
Json sides_json(const ReceivedEnergy& front, const ReceivedEnergy& back) {
    Json entry    = energy_json(front);
    entry["back"] = back.area > 0 ? energy_json(back) : Json();
    return entry;
}

/// Irradiance, unshadowed, coverage.
std::string csv_sums(const ReceivedEnergy& e) {
    std::string fields = e.answered() ? fmt::format(",{:g},{:g}", e.irradiance, e.unshadowed) : ",,";
    return fields + (e.asked > 0 ? fmt::format(",{:g}", e.unshadowed / e.asked) : ",");
}

/// The fields of kColumns, as in the record; empty where that has null.
std::string csv_figures(const ReceivedEnergy& front, const ReceivedEnergy& back) {
    return fmt::format(
        "{:g}{}{}{}", front.area, csv_sums(front),
        front.answered() ? fmt::format(",{:g},{:g},{:g}", front.colour.x, front.colour.y, front.colour.z) : ",,,",
        back.area > 0 ? csv_sums(back) : ",,,");
}

/// A field of a CSV file.
std::string csv_field(const std::string& text) {
    std::string field = "\"";
    for (const char c : text) field += c == '"' ? "\"\"" : std::string(1, c);
    return field + "\"";
}

/// [side][object or face].
using Sides = std::array<std::vector<ReceivedEnergy>, kSides.size()>;

/// The mean of all frames, by object.
Json mean_of(const std::vector<Sides>& frames, const std::vector<std::string>& names) {
    Json mean = Json::array();
    for (std::size_t o = 0; o < names.size(); ++o) {
        std::array<ReceivedEnergy, kSides.size()> sums;
        const auto n = static_cast<double>(frames.size());
        for (const Sides& objects : frames)
            for (std::size_t k = 0; k < kSides.size(); ++k) {
                sums[k].area += objects[k][o].area / n;
                sums[k].irradiance += objects[k][o].irradiance / n;
                sums[k].colour += objects[k][o].colour / n;
                sums[k].unshadowed += objects[k][o].unshadowed / n;
                sums[k].asked += objects[k][o].asked / n;
            }
        Json entry    = sides_json(sums[0], sums[1]);
        entry["name"] = names[o];
        mean.push_back(std::move(entry));
    }
    return mean;
}

std::string fixed(const Json& value) { return value.is_null() ? "-" : fmt::format("{:.3f}", value.get<double>()); }

std::string general(const Json& value) { return value.is_null() ? "-" : fmt::format("{:.4g}", value.get<double>()); }

}  // namespace

std::vector<ReceivedEnergy> received_by_faces(const Scene& scene, const SceneFacts& facts, const EnergyOptions& options,
                                              FaceSide side) {
    std::vector<double> areas(scene.triangles.size());
    for (TriangleId t = 0; t < areas.size(); ++t)
        if (has_side(scene, facts, t, side)) areas[t] = glm::length(area_normal(scene, t)) / 2;
    const FacePoints spread  = spread_points(scene, areas, side, options.points);
    const PointBatch& points = spread.points;
    std::vector<ReceivedEnergy> faces(areas.size());
    if (points.size() == 0) return faces;
    const auto visibility = AskedMethod(scene, facts, options.method)(points);
    for (TriangleId t = 0; t < areas.size(); ++t) {
        ReceivedEnergy& face = faces[t];
        face.area            = areas[t];
        for (std::size_t i = spread.first[t]; i < spread.first[t + 1]; ++i)
            for (LightId j = 0; j < scene.lights.size(); ++j) {
                if (points.triangle[i] == kNoTriangle || !points.faces(j, i)) continue;
                const dvec3 all = arriving(scene, points, j, i);
                face.asked += luminance(all);
                if (!visibility[j].defined(i)) continue;
                face.unshadowed += luminance(all);
                const std::vector<vec3>& coloured = visibility[j].colour;
                face.colour +=
                    all * (coloured.empty() ? dvec3(static_cast<double>(visibility[j].s[i])) : dvec3(coloured[i]));
            }
        const auto n = static_cast<double>(std::max<std::size_t>(1, spread.first[t + 1] - spread.first[t]));
        face.colour /= n, face.unshadowed /= n, face.asked /= n;
        face.irradiance = luminance(face.colour);
    }
    return faces;
}

std::vector<ReceivedEnergy> received_by_objects(const Scene& scene, std::span<const ReceivedEnergy> faces) {
    std::vector<ReceivedEnergy> objects(scene.objects.size());
    for (TriangleId t = 0; t < faces.size(); ++t) {
        ReceivedEnergy& object = objects[scene.triangle_object[t]];
        object.area += faces[t].area;
        object.irradiance += faces[t].area * faces[t].irradiance;
        object.colour += faces[t].area * faces[t].colour;
        object.unshadowed += faces[t].area * faces[t].unshadowed;
        object.asked += faces[t].area * faces[t].asked;
    }
    for (ReceivedEnergy& object : objects)
        if (object.area > 0) {
            object.irradiance /= object.area, object.colour /= object.area;
            object.unshadowed /= object.area, object.asked /= object.area;
        }
    return objects;
}

Json measure_energy(std::span<const fs::path> scenes, const EnergyOptions& options, const fs::path& folder) {
    Json frames = Json::array();
    std::vector<Sides> received;
    std::vector<std::string> names;
    std::string face_rows = fmt::format("scene,object,triangle,{}", kColumns),
                rows      = fmt::format("scene,object,{}", kColumns);
    for (const auto& [file, name, place] : chosen_scenes(scenes)) {
        Scene scene = load_scene(file);
        scene.name  = name;
        if (options.progress) options.progress(scene.name);
        const SceneFacts facts = find_facts(scene);
        if (options.method)
            if (const Service service = verdict(*options.method->make(), facts); !service)
                throw UsageError(
                    fmt::format("{} does not serve {}: {}", options.method->text(), scene.name, service.why));
        std::vector<std::string> objects;
        for (const Object& object : scene.objects) objects.push_back(object.name);
        if (names.empty()) names = objects;
        if (objects != names)
            throw UsageError(fmt::format("{} has other objects than {}, expected frames of one scene", scene.name,
                                         frames[0]["scene"].get<std::string>()));
        Sides faces;
        Sides& by_side = received.emplace_back();
        for (std::size_t k = 0; k < kSides.size(); ++k) {
            faces[k]   = received_by_faces(scene, facts, options, kSides[k]);
            by_side[k] = received_by_objects(scene, faces[k]);
        }
        Json by_object = Json::array();
        for (std::size_t o = 0; o < names.size(); ++o) {
            Json entry    = sides_json(by_side[0][o], by_side[1][o]);
            entry["name"] = names[o];
            rows += fmt::format("{},{},{}\n", csv_field(scene.name), csv_field(names[o]),
                                csv_figures(by_side[0][o], by_side[1][o]));
            by_object.push_back(std::move(entry));
        }
        for (TriangleId t = 0; t < faces[0].size(); ++t)
            face_rows += fmt::format("{},{},{},{}\n", csv_field(scene.name), csv_field(names[scene.triangle_object[t]]),
                                     t, csv_figures(faces[0][t], faces[1][t]));
        frames.push_back({{"scene", scene.name}, {"title", scene.title}, {"objects", std::move(by_object)}});
    }
    write_text(folder / "objects.csv", rows);
    write_text(folder / "faces.csv", face_rows);
    Json mean   = mean_of(received, names);
    Json record = to_record(head_record(options.command));
    record.update({{"method", options.method ? Json(options.method->text()) : Json()},
                   {"unit", kUnit},
                   {"points", options.points},
                   {"frames", std::move(frames)},
                   {"mean", std::move(mean)}});
    return record;
}

std::string energy_text(const Json& record) {
    std::vector<std::pair<std::string, Json>> rows;
    for (const Json& object : record["mean"]) {
        const auto& name = object["name"].get_ref<const std::string&>();
        rows.emplace_back(name, object);
        if (const Json& back = object["back"]; !back.is_null() && !back["coverage"].is_null())
            rows.emplace_back(name + ", back", back);
    }
    std::size_t widest = 8;
    bool in_part       = false;
    for (const auto& [name, energy] : rows) {
        widest  = std::max(widest, name.size());
        in_part = in_part || (energy["coverage"].is_number() && energy["coverage"] < 1);
    }
    std::string text =
        fmt::format("irradiance without shadows, with shadows, and their quotient; means of {} frame{}\n",
                    record["frames"].size(), record["frames"].size() == 1 ? "" : "s");
    text += fmt::format("unit: {}\n", record["unit"].get_ref<const std::string&>());
    if (in_part)
        text += fmt::format("of the part that {} answers; last column: that part of what arrives without shadows\n",
                            record["method"].get_ref<const std::string&>());
    for (const auto& [name, energy] : rows)
        text += fmt::format("{:<{}} {:>10} {:>10} {:>6}{}\n", name, widest, general(energy["unshadowed"]),
                            general(energy["irradiance"]), fixed(energy["fraction"]),
                            in_part ? fmt::format(" {:>6}", fixed(energy["coverage"])) : "");
    return text;
}

}  // namespace umbra
