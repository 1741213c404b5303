#include "umbra/core/io/gltf/cameras.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/scene/names.h"

namespace umbra {
Lens read_lens(const JsonText& json, const JsonValue& v, std::size_t index, std::vector<std::string>& warnings) {
    const auto what = fmt::format("cameras[{}]", index);
    (void)json.object(v, what);
    Lens lens;
    const JsonValue* type = find_member(v, "type");
    if (!type) json.fail(v, what + " has no type, expected perspective or orthographic");
    lens.camera.projection      = json.choice<Projection>(*type, "type");
    const bool perspective      = lens.camera.projection == Projection::perspective;
    const std::string_view kind = name_of(lens.camera.projection);
    const JsonValue* p          = find_member(v, kind);
    if (!p) json.fail(v, fmt::format("{} has no \"{}\"", what, kind));
    (void)json.object(*p, what);
    const auto need = [&](std::string_view key, const Range& range) {
        const JsonValue* x = find_member(*p, key);
        if (!x) json.fail(*p, fmt::format("{} has no {}", what, key));
        return json.number(*x, key, range);
    };
    constexpr Range kAnyFar{kPositive.min, HUGE_VAL, "a positive number"};  // no picture depends on it
    const double znear = perspective ? need("znear", kPositive) : need("znear", kNotNegative);
    if (const JsonValue* zfar = find_member(*p, "zfar"); zfar || !perspective) {
        const double z = zfar ? json.number(*zfar, "zfar", kAnyFar) : need("zfar", kAnyFar);
        if (z <= znear) json.fail(*zfar, fmt::format("zfar {:g} is not beyond znear {:g}", z, znear));
    }
    if (perspective) {
        const double yfov = need("yfov", kFieldOfViewRadians);
        lens.camera.fov_y = static_cast<float>(glm::degrees(yfov));
        lens.aspect       = number_or(json, p, "aspectRatio", kPositive, 0);
    } else {
        const double x = need("xmag", kAnyNumber), y = need("ymag", kAnyNumber);
        if (x == 0 || y == 0) json.fail(*p, what + ": xmag or ymag is 0, expected positive numbers");
        if (x < 0 || y < 0) warnings.push_back(what + ": the signs of xmag and ymag are ignored.");
        lens.camera.height = static_cast<float>(2 * std::abs(y));
        lens.aspect        = std::abs(x / y);
    }
    return lens;
}

void set_picture_size(Scene& scene, double aspect) {
    if (aspect == 0) return;
    scene.width  = aspect >= 1 ? 640 : int(std::lround(std::max(1.0, 640 * aspect)));
    scene.height = aspect >= 1 ? int(std::lround(std::max(1.0, 640 / aspect))) : 640;
}

}  // namespace umbra
