#include "umbra/bench/compare/values_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/pages/embed.h"
#include "umbra/bench/pages/values_call.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace {

constexpr const char* kReference = "Reference";

/// `colour` gives the three bytes of a point.
template <class Colour>
std::string data_url(const PointBatch& points, const Colour& colour) {
    Image image(points.raster->width, points.raster->height, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const uvec3 bytes = colour(i);
        for (int k = 0; k < 3; ++k) image.at(i, static_cast<std::size_t>(k)) = static_cast<float>(bytes[k]) / 255;
    }
    return data_uri("image/png", png_bytes(image));
}

}  // namespace

ValuesScript::ValuesScript(const Scene& scene, const PointBatch& points, const MethodRun& reference)
    : scene_(scene), points_(points), columns_{{kReference, "", planes_of(reference, {})}} {}

std::vector<std::string> ValuesScript::planes_of(const MethodRun& run, std::span<const Explained> explained) const {
    std::vector<std::string> planes(scene_.lights.size());
    parallel_ranges(planes.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j)
            planes[j] = data_url(points_, [&](std::size_t i) {
                const VisibilityPlane& plane = run.planes[j];
                const ErrorClass c           = !explained.empty()                   ? explained[j].classes[i]
                                               : points_.triangle[i] == kNoTriangle ? ErrorClass::no_surface
                                                                                    : ErrorClass::right;
                const float s                = plane.defined(i) ? std::clamp(plane.s[i], 0.0f, 1.0f) : 0;
                return uvec3(std::lround(255 * s), static_cast<unsigned>(c), plane.defined(i) ? 255 : 0);
            });
    });
    return planes;
}

void ValuesScript::add(const std::string& who, const MethodRun& run, std::span<const Explained> explained,
                       const MethodRun* truth) {
    std::string other;
    if (truth != nullptr) {
        other = fmt::format("{}: {}", kReference, truth->choice.text());
        if (std::ranges::none_of(columns_, [&](const Column& c) { return c.who == other; }))
            columns_.push_back({other, "", planes_of(*truth, {})});
    }
    columns_.push_back({who, other.empty() ? kReference : other, planes_of(run, explained)});
}

void ValuesScript::remove(const std::string& who) {
    std::erase_if(columns_, [&](const Column& column) { return column.who == who; });
}

std::string ValuesScript::text() const {
    Json columns = Json::array(), lights = Json::array(), objects = Json::array();
    for (const Column& column : columns_) {
        columns.push_back({{"who", column.who}, {"planes", column.planes}});
        if (!column.truth.empty()) columns.back()["truth"] = column.truth;
    }
    for (const Light& light : scene_.lights) lights.push_back(light.name);
    for (const Object& object : scene_.objects) objects.push_back({object.name, object.triangle_count});
    const std::string faces = data_url(points_, [&](std::size_t i) {
        const std::uint32_t t = points_.triangle[i] == kNoTriangle ? 0 : points_.triangle[i] + 1;
        return uvec3(t >> 16 & 255, t >> 8 & 255, t & 255);
    });
    const Json values       = {{"schema", 1},
                               {"width", points_.raster->width},
                               {"height", points_.raster->height},
                               {"lights", lights},
                               {"classes", kErrorClassNames},
                               {"columns", columns},
                               {"faces", faces},
                               {"objects", objects}};
    return values_call(values);
}

}  // namespace umbra
