#include "umbra/bench/view/view_request.h"

#include <fmt/format.h>

#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/scene/scene.h"

namespace umbra {
namespace {

/// A number that a page has left out, or null, is read as NaN.
void check_known(double x, const char* what) {
    if (std::isnan(x)) throw UsageError(fmt::format("{}: not there, expected a number", what));
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
            check_known(light.size, "size");
    for (const PlacedObject& object : request.objects)
        check_vector(object.move, "move"), check_known(object.turn, "turn");
    return request;
}

}  // namespace umbra
