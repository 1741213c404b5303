// What a page of `umbra view` asks for: the state of the scene and what is shown of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/record/field.h"
#include "umbra/bench/record/record.h"

namespace umbra {

/// Largest picture that a page may ask for, pixels.
inline constexpr double kMostViewPixels = 1 << 20;

/// A light as the page has placed it, world space. Members that the light's kind does not have mean nothing.
struct PlacedLight {
    std::uint64_t light = 0;
    std::vector<double> position{}, direction{};
    double size = 1;  ///< factor of the edges or the radius of an area light
    [[nodiscard]] bool operator==(const PlacedLight&) const = default;
};
template <class Fields>
void describe(Fields& of, Is<PlacedLight>) {
    of("light", &PlacedLight::light, "its number in the scene", {.least = 0, .most = 1e6});
    of("position", &PlacedLight::position, "", kThreeNumbers);
    of("direction", &PlacedLight::direction, "", kThreeNumbers);
    of("size", &PlacedLight::size, "factor of its size in the file", {.least = 0.01, .most = 100});
}

/// An object as the page has placed it.
struct PlacedObject {
    std::uint64_t object = 0;
    std::vector<double> move{};
    double turn = 0;  ///< degrees about the vertical axis through the middle of the object's box
    [[nodiscard]] bool operator==(const PlacedObject&) const = default;
};
template <class Fields>
void describe(Fields& of, Is<PlacedObject>) {
    of("object", &PlacedObject::object, "its number in the scene", {.least = 0, .most = 1e6});
    of("move", &PlacedObject::move, "world units", kThreeNumbers);
    of("turn", &PlacedObject::turn, "degrees about the vertical axis", {.least = -360, .most = 360});
}

struct ViewRequest {
    std::string page{};  ///< names the page among those that are open
    std::uint64_t width = 0, height = 0;
    std::uint64_t frame = 0;
    std::vector<double> eye{}, target{};
    std::vector<PlacedLight> lights{};
    std::vector<PlacedObject> objects{};
    std::vector<std::string> methods{};
    std::uint64_t light = 0;
    std::string layer{};
    std::uint64_t truth = 0;
    std::optional<std::uint64_t> x{}, y{};
};
template <class Fields>
void describe(Fields& of, Is<ViewRequest>) {
    of.must("page", &ViewRequest::page, "a name that the page has given itself");
    of.must("width", &ViewRequest::width, "pixels", {.least = 16, .most = 1920});
    of.must("height", &ViewRequest::height, "pixels", {.least = 16, .most = 1920});
    of("frame", &ViewRequest::frame, "of the file's animation", {.least = 0, .most = 1e6});
    of("eye", &ViewRequest::eye, "world space", kThreeNumbers);
    of("target", &ViewRequest::target, "world space", kThreeNumbers);
    of("lights", &ViewRequest::lights, "those that are not where the file has them");
    of("objects", &ViewRequest::objects, "those that are not where the file has them");
    of("methods", &ViewRequest::methods, "one or two, as typed on a command line");
    of("light", &ViewRequest::light, "whose S_j is shown");
    of("layer", &ViewRequest::layer, "", one_of({"visibility", "picture", "difference", "classes", "flip"}));
    of("truth", &ViewRequest::truth,
       "0: none; 1: area lights at a sample of the points; 2: at as many as compare takes", {.least = 0, .most = 2});
    of.may("x", &ViewRequest::x, "column of the pixel that is asked about");
    of.may("y", &ViewRequest::y, "its row");
}

/// Throws InputError, where /POINTER of the request is not as described, and UsageError where the picture is too large
/// or no method is named.
[[nodiscard]] ViewRequest view_request(const std::string& json);

}  // namespace umbra
