#include "umbra/core/io/native/transforms.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "umbra/core/io/native/directions.h"

namespace umbra {
namespace {

dmat4 read_matrix(const JsonText& json, const JsonValue& v) {
    constexpr std::string_view expected = "three or four rows of four numbers";
    const auto& rows                    = json.array(v, "matrix", expected);
    if (rows.size() != 3 && rows.size() != 4) json.wrong_type(v, "matrix", expected);
    dmat4 m(1);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto& row = json.array(rows[r], "a row of the matrix", "four numbers");
        if (row.size() != 4) json.wrong_type(rows[r], "a row of the matrix", "four numbers");
        for (std::size_t c = 0; c < 4; ++c) m[int(c)][int(r)] = json.number(row[c], "an entry", kAnyNumber);
    }
    if (dvec4(m[0][3], m[1][3], m[2][3], m[3][3]) != dvec4(0, 0, 0, 1))
        json.fail(rows[3], "the last row of the matrix is not [0, 0, 0, 1]");
    if (glm::determinant(dmat3(m)) == 0) json.fail(v, "the matrix flattens what it transforms: its determinant is 0");
    return m;
}

/// Scales evenly to an extent, then puts the body on the ground, y = 0, with its box's centre over the origin.
dmat4 read_fit(const JsonText& json, const JsonValue& v, const dmat4& before, const std::vector<NativePart>& parts) {
    dvec3 low(kInfinity), high(-kInfinity);
    for (const NativePart& part : parts)
        for (const vec3 p : part.mesh.positions) {
            const dvec3 q(before * dvec4(dvec3(p) + part.origin, 1));
            low = glm::min(low, q), high = glm::max(high, q);
        }
    const dvec3 extent = high - low;
    double has         = std::max({extent.x, extent.y, extent.z});
    double wanted      = 0;
    if (std::holds_alternative<JsonObject>(v.data)) {
        const JsonFields f(json, v, "fit", {"size", "width", "height", "depth"});
        if (json.object(v, "fit").size() != 1) json.fail(v, "fit names one of size, width, height, depth");
        for (const auto& [key, along] :
             {std::pair{"size", has}, {"width", extent.x}, {"height", extent.y}, {"depth", extent.z}})
            if (const JsonValue* given = f.find(key)) wanted = json.number(*given, key, kPositive), has = along;
    } else {
        wanted = json.number(v, "fit", kPositive);
    }
    if (!(has > 0)) json.fail(v, "the body has no extent that could be scaled");
    const double s = wanted / has;
    return glm::scale(dmat4(1), dvec3(s)) *
           glm::translate(dmat4(1), -dvec3((low.x + high.x) / 2, low.y, (low.z + high.z) / 2));
}

dmat4 read_step(const JsonText& json, const JsonMember& step, const dmat4& before,
                const std::vector<NativePart>& parts) {
    const JsonValue& v = step.value;
    if (step.key == "translate") return glm::translate(dmat4(1), json.vector(v, "translate", kAnyNumber));
    if (step.key == "scale") {
        const bool even   = std::holds_alternative<double>(v.data);
        const dvec3 scale = even ? dvec3(json.number(v, "scale", kAnyNumber)) : json.vector(v, "scale", kAnyNumber);
        if (scale.x == 0 || scale.y == 0 || scale.z == 0)
            json.fail(v, "scale is 0, which flattens, expected numbers other than 0");
        return glm::scale(dmat4(1), scale);
    }
    if (step.key == "rotate_x" || step.key == "rotate_y" || step.key == "rotate_z") {
        dvec3 axis(0);
        axis[step.key.back() - 'x'] = 1;
        return glm::rotate(dmat4(1), glm::radians(json.number(v, step.key, kRotation)), axis);
    }
    if (step.key == "rotate") {
        const JsonFields f(json, v, "rotate", {"axis", "angle"});
        const dvec3 axis(read_direction(json, f.require("axis"), "axis"));
        return glm::rotate(dmat4(1), glm::radians(json.number(f.require("angle"), "angle", kRotation)),
                           glm::normalize(axis));
    }
    if (step.key == "matrix") return read_matrix(json, v);
    if (step.key == "fit") return read_fit(json, v, before, parts);
    json.unknown(step.offset, "transform", step.key,
                 {"translate", "scale", "rotate_x", "rotate_y", "rotate_z", "rotate", "matrix", "fit"});
}

}  // namespace

dmat4 read_transform(const JsonText& json, const JsonValue& v, const std::vector<NativePart>& parts) {
    dmat4 m(1);
    for (const JsonValue& step :
         json.array(v, "transform", "a list of steps such as [{\"scale\": 2}, {\"rotate_y\": 30}]")) {
        const auto& members = json.object(step, "a step of the transform");
        if (members.size() != 1)
            json.fail(step, fmt::format(
                                "a step of the transform has {} keys, expected one per step, since their order matters",
                                members.size()));
        m = read_step(json, members[0], m, parts) * m;
    }
    return m;
}

}  // namespace umbra
