// The names of enum values in scene files, messages and tables: one table per enum, which every reader and the writer
// use.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "umbra/core/scene/lights.h"
#include "umbra/core/scene/materials.h"
#include "umbra/core/scene/photometry.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

template <class Enum>
struct Named {
    Enum value;
    std::string_view name;
};

/// EnumNames<Enum>::table lists every value of Enum, in the order in which messages list them.
template <class Enum>
struct EnumNames;

template <>
struct EnumNames<LightKind> {
    static constexpr std::array<Named<LightKind>, 6> table{{{LightKind::directional, "directional"},
                                                            {LightKind::point, "point"},
                                                            {LightKind::spot, "spot"},
                                                            {LightKind::rectangle, "rectangle"},
                                                            {LightKind::disk, "disk"},
                                                            {LightKind::sphere, "sphere"}}};
};

template <>
struct EnumNames<SpotFalloff> {
    static constexpr std::array<Named<SpotFalloff>, 3> table{
        {{SpotFalloff::cosine, "cosine"}, {SpotFalloff::zachmann, "zachmann"}, {SpotFalloff::smooth, "smooth"}}};
};

template <>
struct EnumNames<Lobe> {
    static constexpr std::array<Named<Lobe>, 2> table{{{Lobe::phong, "phong"}, {Lobe::blinn_phong, "blinn_phong"}}};
};

template <>
struct EnumNames<ToneMap> {
    static constexpr std::array<Named<ToneMap>, 3> table{
        {{ToneMap::clamp, "clamp"}, {ToneMap::divide, "divide"}, {ToneMap::hue, "hue"}}};
};

template <>
struct EnumNames<LightAmbient> {
    static constexpr std::array<Named<LightAmbient>, 2> table{
        {{LightAmbient::constant, "constant"}, {LightAmbient::attenuated, "attenuated"}}};
};

template <>
struct EnumNames<SpecularColour> {
    static constexpr std::array<Named<SpecularColour>, 2> table{
        {{SpecularColour::O_s, "O_s"}, {SpecularColour::O_d, "O_d"}}};
};

template <>
struct EnumNames<AmbientCoefficient> {
    static constexpr std::array<Named<AmbientCoefficient>, 2> table{
        {{AmbientCoefficient::k_a, "k_a"}, {AmbientCoefficient::k_d, "k_d"}}};
};

template <>
struct EnumNames<TransparentOccluders> {
    static constexpr std::array<Named<TransparentOccluders>, 3> table{{{TransparentOccluders::ignore, "ignore"},
                                                                       {TransparentOccluders::block, "block"},
                                                                       {TransparentOccluders::multiply, "multiply"}}};
};

template <>
struct EnumNames<UpAxis> {
    static constexpr std::array<Named<UpAxis>, 3> table{{{UpAxis::y, "y"}, {UpAxis::z, "z"}, {UpAxis::minus_y, "-y"}}};
};

template <>
struct EnumNames<NormalWeights> {
    static constexpr std::array<Named<NormalWeights>, 3> table{
        {{NormalWeights::angle, "angle"}, {NormalWeights::area, "area"}, {NormalWeights::equal, "equal"}}};
};

template <>
struct EnumNames<PhotometricType> {
    static constexpr std::array<Named<PhotometricType>, 3> table{
        {{PhotometricType::C, "C"}, {PhotometricType::B, "B"}, {PhotometricType::A, "A"}}};
};

template <>
struct EnumNames<FogLaw> {
    static constexpr std::array<Named<FogLaw>, 4> table{{{FogLaw::none, "none"},
                                                         {FogLaw::linear, "linear"},
                                                         {FogLaw::exponential, "exponential"},
                                                         {FogLaw::exponential_squared, "exponential_squared"}}};
};

template <>
struct EnumNames<FogDistance> {
    static constexpr std::array<Named<FogDistance>, 2> table{
        {{FogDistance::radial, "radial"}, {FogDistance::depth, "depth"}}};
};

template <>
struct EnumNames<Projection> {
    static constexpr std::array<Named<Projection>, 2> table{
        {{Projection::perspective, "perspective"}, {Projection::orthographic, "orthographic"}}};
};

/// Scene::local_viewer as an enum, for its names alone.
enum class Viewer : bool { infinite = false, local = true };
template <>
struct EnumNames<Viewer> {
    static constexpr std::array<Named<Viewer>, 2> table{{{Viewer::local, "local"}, {Viewer::infinite, "infinite"}}};
};

/// Whether Light::camera_pose is set, as an enum, for its names alone.
enum class FixedTo : bool { scene = false, camera = true };
template <>
struct EnumNames<FixedTo> {
    static constexpr std::array<Named<FixedTo>, 2> table{{{FixedTo::scene, "scene"}, {FixedTo::camera, "camera"}}};
};

template <class Enum>
[[nodiscard]] constexpr std::string_view name_of(Enum value) {
    for (const auto& entry : EnumNames<Enum>::table)
        if (entry.value == value) return entry.name;
    return "";
}

/// All values, for a reader that accepts any of them.
template <class Enum>
[[nodiscard]] std::vector<Enum> values_of() {
    std::vector<Enum> values;
    for (const auto& entry : EnumNames<Enum>::table) values.push_back(entry.value);
    return values;
}

}  // namespace umbra
