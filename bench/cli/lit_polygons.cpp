#include "umbra/bench/cli/lit_polygons.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "umbra/bench/base/files.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/shadows/atherton/atherton_weiler.h"

namespace umbra {
namespace {

using Seen   = LitPolygons::Seen;
using Out    = std::back_insert_iterator<std::string>;
namespace fs = std::filesystem;

/// A triangle of the scene in world space, and what a light sees of it.
class LitTriangle {
public:
    LitTriangle(const LitPolygons& polygons, TriangleId t)
        : polygons_(polygons),
          t_(t),
          seen_(polygons.seen(t) == Seen::unknown || polygons.scene().switches(t).receives_shadows ? polygons.seen(t)
                                                                                                   : Seen::lit),
          a_(polygons.scene().vertex(t, 0)),
          ab_(dvec3(polygons.scene().vertex(t, 1)) - a_),
          ac_(dvec3(polygons.scene().vertex(t, 2)) - a_) {}

    [[nodiscard]] dvec3 at(dvec2 uv) const { return a_ + uv.x * ab_ + uv.y * ac_; }
    [[nodiscard]] double area() const { return seen_ == Seen::unknown ? 0 : glm::length(glm::cross(ab_, ac_)) / 2; }
    /// The lit polygons' triangles.
    [[nodiscard]] std::vector<std::array<dvec2, 3>> triangles() const {
        if (seen_ == Seen::parts) return polygons_.lit_triangles(t_);
        if (seen_ == Seen::lit) return {{dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)}};
        return {};
    }
    /// Their outlines.
    [[nodiscard]] std::vector<std::vector<dvec2>> loops() const {
        if (seen_ == Seen::parts) return polygons_.lit_loops(t_);
        if (seen_ == Seen::lit) return {whole()};
        return {};
    }
    [[nodiscard]] static std::vector<dvec2> whole() { return {{0, 0}, {1, 0}, {0, 1}}; }
    [[nodiscard]] bool is_wound_towards(dvec3 direction) const { return glm::dot(glm::cross(ab_, ac_), direction) > 0; }
    [[nodiscard]] double lit_area() const {
        double fraction = 0;
        for (const auto& [p, q, r] : triangles()) fraction += (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
        return fraction * area();
    }

private:
    const LitPolygons& polygons_;
    TriangleId t_;
    Seen seen_;
    dvec3 a_, ab_, ac_;
};

/// A name in a line of an OBJ file: control characters would end it.
std::string in_one_line(std::string name) {
    for (char& c : name)
        if (static_cast<unsigned char>(c) < ' ') c = '_';
    return name;
}

std::string mesh_text(const LitPolygons& polygons, const std::string& title) {
    std::string text   = fmt::format("# {}\n", in_one_line(title));
    std::size_t vertex = 1;
    for (const Object& object : polygons.scene().objects) {
        fmt::format_to(Out(text), "o {}\n", in_one_line(object.name));
        for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
            const LitTriangle triangle(polygons, t);
            for (const auto& corners : triangle.triangles()) {
                for (const dvec2 uv : corners) {
                    const dvec3 p = triangle.at(uv);
                    fmt::format_to(Out(text), "v {} {} {}\n", p.x, p.y, p.z);
                }
                fmt::format_to(Out(text), "f {} {} {}\n", vertex, vertex + 1, vertex + 2);
                vertex += 3;
            }
        }
    }
    return text;
}

/// Positions in a plane, seen from the side of its normal.
struct Frame {
    dvec3 right{1, 0, 0}, up{0, 1, 0};

    explicit Frame(dvec3 normal) {
        // The world's up is the drawing's; a level plane has -z there, as a map has north.
        const dvec3 guide = std::abs(normal.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(0, 0, -1);
        right             = glm::normalize(glm::cross(guide, normal));
        up                = glm::cross(normal, right);
    }
    /// y runs down, as in SVG.
    [[nodiscard]] dvec2 at(dvec3 p) const { return {glm::dot(right, p), -glm::dot(up, p)}; }
};

/// Loops that run one way in all triangles, so that the nonzero rule fills what several of them share.
void append_path(std::string& d, const Frame& frame, const LitTriangle& triangle, std::vector<dvec2> loop,
                 bool turned) {
    if (turned) std::ranges::reverse(loop);
    char step = 'M';
    for (const dvec2 uv : loop) {
        const dvec2 p = frame.at(triangle.at(uv));
        fmt::format_to(Out(d), "{}{} {}", step, p.x, p.y);
        step = 'L';
    }
    d += "Z";
}

std::string drawing_text(const LitPolygons& polygons, const PlanarReceiver& plane, const std::string& title) {
    const Frame frame(plane.normal);
    dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
    std::string dark, unseen, bright;
    for (const TriangleId t : plane.triangles) {
        const LitTriangle triangle(polygons, t);
        for (const dvec2 uv : LitTriangle::whole()) {
            const dvec2 p = frame.at(triangle.at(uv));
            low           = glm::min(low, p);
            high          = glm::max(high, p);
        }
        const bool turned = !triangle.is_wound_towards(plane.normal);
        append_path(polygons.seen(t) == Seen::unknown ? unseen : dark, frame, triangle, LitTriangle::whole(), turned);
        for (const auto& loop : triangle.loops()) append_path(bright, frame, triangle, loop, turned);
    }
    const dvec2 size    = high - low;
    const double margin = 0.02 * std::max(size.x, size.y), line_width = 0.1 * margin;
    std::string text = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{} {} {} {}\">\n<title>{}</title>\n"
        "<g stroke-width=\"{}\" stroke-linejoin=\"round\">\n",
        low.x - margin, low.y - margin, size.x + 2 * margin, size.y + 2 * margin, xml_text(title), line_width);
    const auto add = [&](std::string_view name, const std::string& path, std::string_view fill, std::string_view line) {
        if (!path.empty())
            fmt::format_to(Out(text), "<path class=\"{}\" fill=\"{}\" stroke=\"{}\" d=\"{}\"/>\n", name, fill, line,
                           path);
    };
    add("umbra", dark, "#223", "#223");
    add("edge-on", unseen, "#999", "#999");
    add("lit", bright, "#fd8", "#a60");
    return text + "</g>\n</svg>\n";
}

template <class Triangles>
LitAreaRecord lit_area(const LitPolygons& polygons, const Triangles& triangles) {
    LitAreaRecord sum{0, 0};
    for (const TriangleId t : triangles) {
        const LitTriangle triangle(polygons, t);
        sum.area += triangle.area();
        sum.lit_area += triangle.lit_area();
    }
    return sum;
}

/// Names of files: the light's, with its number where two lights have one name.
std::vector<std::string> file_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const Light& light : scene.lights) {
        std::string name = folder_name(light.name);
        if (std::ranges::find(names, name) != names.end()) name += fmt::format("-{}", names.size() + 1);
        names.push_back(std::move(name));
    }
    return names;
}

}  // namespace

LitPolygonsRecord write_lit_polygons(const Scene& scene, const SceneFacts& facts, const fs::path& folder) {
    LitPolygonsRecord record{.version = std::string(version()), .scene = scene_record(scene)};
    const std::vector<std::string> names       = file_names(scene);
    const std::unique_ptr<const Method> method = atherton_weiler.make();
    const std::unique_ptr<const Built> built   = method->build(scene, facts);
    std::vector<TriangleId> all(scene.triangles.size());
    std::iota(all.begin(), all.end(), TriangleId{0});
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        const std::unique_ptr<const Aimed> aimed = method->aim(*built, light);
        const auto& polygons                     = as<LitPolygons>(*aimed);
        const std::string title = fmt::format("What {} lights in {}", scene.lights[light].name, scene.name);
        LitLightRecord entry{scene.lights[light].name, names[light] + ".obj", lit_area(polygons, all)};
        write_text(folder / entry.mesh, mesh_text(polygons, title));
        for (std::size_t k = 0; k < facts.planes.size(); ++k) {
            const PlanarReceiver& plane = facts.planes[k];
            LitPlaneRecord drawn{fmt::format("{}_plane_{}.svg", names[light], k + 1),
                                 {plane.normal.x, plane.normal.y, plane.normal.z},
                                 lit_area(polygons, plane.triangles)};
            write_text(folder / drawn.drawing, drawing_text(polygons, plane, title));
            entry.planes.push_back(std::move(drawn));
        }
        record.lights.push_back(std::move(entry));
    }
    return record;
}

std::string lit_polygons_text(const LitPolygonsRecord& record) {
    std::string text;
    const auto line = [&](const std::string& name, const LitAreaRecord& of, const std::string& file) {
        fmt::format_to(Out(text), "{:<28} {:>12.6g} of {:>12.6g} lit{}  {}\n", name, of.lit_area, of.area,
                       of.area > 0 ? fmt::format(" ({:.1f} %)", 100 * of.lit_area / of.area) : "", file);
    };
    for (const LitLightRecord& light : record.lights) {
        line(light.name, light.lit, light.mesh);
        for (std::size_t k = 0; k < light.planes.size(); ++k)
            line(fmt::format("  plane {}", k + 1), light.planes[k].lit, light.planes[k].drawing);
    }
    return text;
}

}  // namespace umbra
