// What a page of `umbra view` asks for: the state of the scene and what is shown of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/field.h"
#include "umbra/bench/base/record.h"

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
DESCRIBE(PlacedLight) {
    of(MEMBER(light), "its number in the scene", {.least = 0, .most = 1e6});
    of(MEMBER(position), "", kThreeNumbers);
    of(MEMBER(direction), "", kThreeNumbers);
    of(MEMBER(size), "factor of its size in the file", {.least = 0.01, .most = 100});
}

/// An object as the page has placed it.
struct PlacedObject {
    std::uint64_t object = 0;
    std::vector<double> move{};
    double turn = 0;  ///< degrees about the vertical axis through the middle of the object's box
    [[nodiscard]] bool operator==(const PlacedObject&) const = default;
};
DESCRIBE(PlacedObject) {
    of(MEMBER(object), "its number in the scene", {.least = 0, .most = 1e6});
    of(MEMBER(move), "world units", kThreeNumbers);
    of(MEMBER(turn), "degrees about the vertical axis", {.least = -360, .most = 360});
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
DESCRIBE(ViewRequest) {
    of.must(MEMBER(page), "a name that the page has given itself");
    of.must(MEMBER(width), "pixels", {.least = 16, .most = 1920});
    of.must(MEMBER(height), "pixels", {.least = 16, .most = 1920});
    of(MEMBER(frame), "of the file's animation", {.least = 0, .most = 1e6});
    of(MEMBER(eye), "world space", kThreeNumbers);
    of(MEMBER(target), "world space", kThreeNumbers);
    of(MEMBER(lights), "those that are not where the file has them");
    of(MEMBER(objects), "those that are not where the file has them");
    of(MEMBER(methods), "one or two, as typed on a command line");
    of(MEMBER(light), "whose S_j is shown");
    of(MEMBER(layer), "", one_of({"visibility", "picture", "difference", "classes", "flip"}));
    of(MEMBER(truth), "0: none; 1: area lights at a sample of the points; 2: at as many as compare takes",
       {.least = 0, .most = 2});
    of.may(MEMBER(x), "column of the pixel that is asked about");
    of.may(MEMBER(y), "its row");
}

/// Throws InputError, where /POINTER of the request is not as described, and UsageError where the picture is too large
/// or no method is named.
[[nodiscard]] ViewRequest view_request(const std::string& json);

}  // namespace umbra
