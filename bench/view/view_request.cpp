#include "umbra/bench/view/view_request.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "umbra/core/base/error.h"
#include "umbra/core/scene/scene.h"

namespace umbra {
namespace {

/// A member that a page has left out is not a number.
void check_number(double x, double least, double most, const char* what) {
    if (!(x >= least && x <= most))
        throw UsageError(fmt::format("{}: {}, expected a number from {:g} to {:g}", what, x, least, most));
}

void check_vector(const std::vector<double>& v, const char* what) {
    if (v.size() != 3) throw UsageError(fmt::format("{}: {} numbers, expected 3", what, v.size()));
    for (const double x : v)
        if (!(std::abs(x) <= kMaxCoordinate))
            throw UsageError(fmt::format("{}: {}, expected numbers of at most {:g}", what, x, kMaxCoordinate));
}

}  // namespace

ViewRequest view_request(const std::string& json) {
    ViewRequest request = from_record<ViewRequest>(parse_json(json, "request"));
    for (const auto& [side, what] : {std::pair{request.width, "width"}, {request.height, "height"}})
        check_number(static_cast<double>(side), 16, 1920, what);
    if (static_cast<double>(request.width) * static_cast<double>(request.height) > kMostViewPixels)
        throw UsageError(
            fmt::format("{} x {} pixels, expected at most {:.0f}", request.width, request.height, kMostViewPixels));
    if (request.methods.empty() || request.methods.size() > 2)
        throw UsageError(fmt::format("{} methods, expected 1 or 2", request.methods.size()));
    if (request.lights.size() > 10000 || request.objects.size() > 10000)
        throw UsageError("more than 10000 lights or objects are placed");
    check_vector(request.eye, "eye");
    check_vector(request.target, "target");
    for (const PlacedLight& light : request.lights)
        check_vector(light.position, "position"), check_vector(light.direction, "direction"),
            check_number(light.size, 0.01, 100, "size");
    for (const PlacedObject& object : request.objects)
        check_vector(object.move, "move"), check_number(object.turn, -360, 360, "turn");
    return request;
}

}  // namespace umbra
