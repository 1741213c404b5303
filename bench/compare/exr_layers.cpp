#include "umbra/bench/compare/exr_layers.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr std::size_t kGrain = 16384;  ///< pixels

/// What `value` says of each pixel, which it may be asked from any thread.
template <class T, class Value>
void fill(std::vector<T>& plane, const Value& value) {
    parallel_ranges(plane.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) plane[i] = static_cast<T>(value(i));
    });
}

/// Channels of one float a point, to be interleaved behind those of another image.
class FloatChannels {
public:
    explicit FloatChannels(std::size_t points) : points_(points) {}

    template <class Value>
    void add(std::string name, const Value& value) {
        names_.push_back(std::move(name));
        auto& plane = planes_.emplace_back(points_);
        fill(plane, value);
    }
    /// Gives `all`, which has none, the channels of `image` and these.
    void write_behind(const Image& image, Image& all) const {
        const std::size_t before = image.channels.size();
        all.channels             = image.channels;
        all.channels.insert(all.channels.end(), names_.begin(), names_.end());
        all.data.resize(points_ * all.channels.size());
        parallel_ranges(points_, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t c = 0; c < before; ++c) all.at(i, c) = image.at(i, c);
                for (std::size_t c = 0; c < planes_.size(); ++c) all.at(i, before + c) = planes_[c][i];
            }
        });
    }

private:
    std::size_t points_;
    std::vector<std::string> names_;
    std::vector<std::vector<float>> planes_;
};

template <class Value>
void add_integers(Image& image, const std::string& name, const Value& value) {
    auto& channel = image.integers[name];
    channel.resize(image.pixels());
    fill(channel, value);
}

/// [{"name": ..., "first_triangle": ..., "triangles": ...}, ...] in the order of id.object.
std::string objects_text(const Scene& scene) {
    nlohmann::ordered_json objects = nlohmann::ordered_json::array();
    for (const Object& o : scene.objects)
        objects.push_back({{"name", o.name}, {"first_triangle", o.first_triangle}, {"triangles", o.triangle_count}});
    return objects.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void add_geometry(FloatChannels& floats, Image& image, const Scene& scene, const PointBatch& points) {
    const auto hit = [&](std::size_t i) { return points.triangle[i] != kNoTriangle; };
    floats.add("Z", [&](std::size_t i) {
        return hit(i) ? static_cast<float>(points.raster->project(dvec3(points.position(i))).z) : kInfinity;
    });
    constexpr std::array kAxes = {"x", "y", "z"};
    for (int k = 0; k < 3; ++k)
        floats.add(fmt::format("N.{}", kAxes[static_cast<std::size_t>(k)]),
                   [&](std::size_t i) { return points.normal(i)[k]; });
    for (int k = 0; k < 3; ++k)
        floats.add(fmt::format("P.{}", kAxes[static_cast<std::size_t>(k)]),
                   [&](std::size_t i) { return points.position(i)[k]; });
    floats.add("barycentric.u", [&](std::size_t i) { return hit(i) ? points.u[i] : 0; });
    floats.add("barycentric.v", [&](std::size_t i) { return hit(i) ? points.v[i] : 0; });
    add_integers(image, "id.face", [&](std::size_t i) { return points.triangle[i]; });
    add_integers(image, "id.object",
                 [&](std::size_t i) { return hit(i) ? scene.triangle_object[points.triangle[i]] : kNoTriangle; });
    for (LightId j = 0; j < scene.lights.size(); ++j)
        add_integers(image, "facing." + scene.lights[j].name,
                     [&](std::size_t i) { return static_cast<std::uint32_t>(points.facing[j][i]); });
    image.matrices["worldToCamera"] = world_to_camera(*points.raster);
    image.matrices["worldToNDC"]    = world_to_ndc(*points.raster);
    image.metadata["umbra:objects"] = objects_text(scene);
    image.metadata["umbra:facing"]  = "0 no_surface, 1 away, 2 partly, 3 front, 4 unshadowed";
    image.metadata["umbra:units"] =
        "P and Z: world units; N: unit vectors in world space; S and half_width: fractions of the light";
}

std::string class_names() {
    std::string text;
    for (std::size_t k = 0; k < kErrorClassNames.size(); ++k)
        text += fmt::format("{}{} {}", k == 0 ? "" : ", ", k, kErrorClassNames[k]);
    return text;
}

std::array<float, 16> row_major(const std::array<dvec3, 4>& columns, const std::array<double, 4>& last) {
    std::array<float, 16> m{};
    for (std::size_t c = 0; c < 4; ++c) {
        for (int r = 0; r < 3; ++r) m[static_cast<std::size_t>(r) * 4 + c] = static_cast<float>(columns[c][r]);
        m[12 + c] = static_cast<float>(last[c]);
    }
    return m;
}

}  // namespace

std::array<float, 16> world_to_camera(const CameraFrame& f) {
    return row_major({f.right, f.up, f.forward, dvec3(0)},
                     {-glm::dot(f.right, f.eye), -glm::dot(f.up, f.eye), -glm::dot(f.forward, f.eye), 1});
}

std::array<float, 16> world_to_ndc(const CameraFrame& f) {
    const bool perspective = f.projection == Projection::perspective;
    const dvec3 w          = perspective ? f.forward : dvec3(0);  // what x, y and z are divided by
    const dvec3 x = 0.5 * w + 0.5 / f.half_width * f.right, y = 0.5 * w - 0.5 / f.half_height * f.up;
    const dvec3 z       = perspective ? dvec3(0) : f.forward;
    const double centre = perspective ? 0 : 0.5;
    return row_major({x, y, z, w}, {centre - glm::dot(x, f.eye), centre - glm::dot(y, f.eye),
                                    perspective ? 1 : -glm::dot(z, f.eye), perspective ? -glm::dot(w, f.eye) : 1});
}

Image exr_image(const Image& linear, const Scene& scene, const PointBatch& points, const MethodRun& run,
                const ExrLayers& layers) {
    Image image(linear.width, linear.height, {});
    image.metadata = linear.metadata;
    FloatChannels floats(points.size());
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        const std::string& light     = scene.lights[j].name;
        const VisibilityPlane& plane = run.planes[j];
        floats.add("S." + light, [&](std::size_t i) {
            return plane.defined(i) ? plane.s[i] : std::numeric_limits<float>::quiet_NaN();
        });
        add_integers(image, "answer." + light, [&](std::size_t i) { return plane.answer[i]; });
        if (!layers.explained.empty())
            add_integers(image, "class." + light, [&](std::size_t i) { return layers.explained[j].classes[i]; });
        if (!layers.reference) continue;
        floats.add("half_width." + light, [&](std::size_t i) { return plane.half_width[i]; });
        const auto judged = run.judged_points(j);
        add_integers(image, "judged." + light, [&](std::size_t i) { return judged.empty() || judged[i] != 0; });
    }
    image.metadata["umbra:answer"] = "0 undefined, 1 given, 2 on_boundary";
    if (!layers.explained.empty()) image.metadata["umbra:class"] = class_names();
    if (layers.geometry) add_geometry(floats, image, scene, points);
    floats.write_behind(linear, image);
    return image;
}

}  // namespace umbra
