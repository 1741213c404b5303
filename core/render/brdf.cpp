#include "umbra/core/render/brdf.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/render/lobe_power.h"

namespace umbra {
namespace {

struct LocalFrame {
    dvec3 x, y, z;
    [[nodiscard]] dvec3 local(dvec3 v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
};

LocalFrame local_frame(dvec3 normal, dvec3 tangent) {
    const auto across = [&](dvec3 v) { return v - glm::dot(v, normal) * normal; };
    dvec3 x           = across(glm::normalize(tangent));
    if (glm::length(x) < 1e-6) x = across(std::abs(normal.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0));
    x = glm::normalize(x);
    return {x, glm::cross(normal, x), normal};
}

dvec3 polar(double cosine, double azimuth) {
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

/// Turned about the normal by one radian: far from any symmetry that a function may have by chance.
dvec3 turned(dvec3 v) {
    const double cosine = std::cos(1.0), sine = std::sin(1.0);
    return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z};
}

/// Adds the figures of all directions v for one direction l; differences as they are.
void measure_from(const Brdf& f, dvec3 l, int steps, BrdfFigures& figures) {
    constexpr int kAzimuths = 4;  // of v, a step of its cosine
    double with = 0, without = 0;
    for (int i = 0; i < steps; ++i)
        for (int k = 0; k < kAzimuths * steps; ++k) {
            const dvec3 v       = polar((i + 0.5) / steps, 2 * kPi * (k + 0.5) / (kAzimuths * steps));
            const double value  = f(l, v);
            const double back   = f(v, l);
            figures.largest     = std::max({figures.largest, value, back});
            figures.reciprocity = std::max(figures.reciprocity, std::abs(value - back));
            figures.anisotropy  = std::max(figures.anisotropy, std::abs(value - f(turned(l), turned(v))));
            with += value * v.z;
            without += value;
        }
    // The solid angle of one v: all are equal, since steps are of equal cosine.
    const double solid_angle = 2 * kPi / (static_cast<double>(kAzimuths) * steps * steps);
    figures.energy           = std::max(figures.energy, with * solid_angle);
    figures.without_cosine   = std::max(figures.without_cosine, without * solid_angle);
}

}  // namespace

// In double, since in float a cosine near 1 is off by 6e-8, which a shininess of 1e6 turns into 6 % of the highlight.
double lobe_cosine(const Material& material, dvec3 n, dvec3 l, dvec3 v) {
    if (material.lobe == Lobe::phong) return glm::dot(2 * glm::dot(n, l) * n - l, v);
    const dvec3 h       = l + v;
    const double length = glm::length(h);
    return length > 0 ? glm::dot(n, h) / length : 0;  // V = -L: no half vector, no highlight
}

double specular_lobe(const Material& material, dvec3 n, dvec3 l, dvec3 v) {
    return lobe_power(std::clamp(lobe_cosine(material, n, l, v), 0.0, 1.0), material.shininess);
}

dvec3 lafortune_lobes(const Material& material, dvec3 n, dvec3 l, dvec3 v) {
    const LocalFrame frame = local_frame(n, dvec3(material.tangent));
    const dvec3 to_light = frame.local(l), to_eye = frame.local(v);
    constexpr double kLargest = 1e30;  // a matrix and an exponent may be so large that the power is infinite
    dvec3 sum(0);
    for (const LafortuneLobe& lobe : material.lobes) {
        const dvec3 mirrored(glm::dot(dvec3(lobe.rows[0]), to_light), glm::dot(dvec3(lobe.rows[1]), to_light),
                             glm::dot(dvec3(lobe.rows[2]), to_light));
        const double cosine = glm::dot(to_eye, mirrored);
        if (cosine > 0)
            sum += dvec3(lobe.k_s) * std::min(std::pow(cosine, static_cast<double>(lobe.shininess)), kLargest);
    }
    return sum;
}

dvec3 reflected(const Material& material, dvec3 n, dvec3 l, dvec3 v) {
    const double cosine = glm::dot(n, l);
    if (cosine <= 0) return dvec3(0);
    return dvec3(material.k_d) * dvec3(material.O_d) * cosine +
           dvec3(material.k_s) * dvec3(material.O_s) * specular_lobe(material, n, l, v) +
           lafortune_lobes(material, n, l, v);
}

Brdf brdf_of_sum(const Material& material) {
    return [material](dvec3 l, dvec3 v) { return reflected(material, {0, 0, 1}, l, v).r / (kPi * l.z); };
}

namespace {

/// Pi times the factor that makes the integral of the material's lobe and the cosine 1 at normal incidence.
double peak_of(const Material& material) {
    const double n = material.shininess;
    return material.lobe == Lobe::phong ? (n + 2) / 2 : (n + 2) * (n + 4) / (8 * (std::exp2(-n / 2) + n));
}

}  // namespace

Brdf brdf_with_cosine(const Material& material) {
    return [material](dvec3 l, dvec3 v) {
        const dvec3 n(0, 0, 1);
        const double diffuse  = static_cast<double>(material.k_d.r) * static_cast<double>(material.O_d.r);
        const double specular = static_cast<double>(material.k_s.r) * static_cast<double>(material.O_s.r);
        const double peak     = peak_of(material);
        return (diffuse + specular * peak * specular_lobe(material, n, l, v)) / kPi +
               lafortune_lobes(material, n, l, v).r;
    };
}

BrdfFigures measure_brdf(const Brdf& f, int steps) {
    constexpr int kAbout = 8;
    BrdfFigures figures;
    for (const double degrees : {0, 15, 30, 45, 60, 75, 85, 89})
        for (int k = 0; k < kAbout; ++k)
            measure_from(f, polar(std::cos(glm::radians(degrees)), 2 * kPi * k / kAbout), steps, figures);
    if (figures.largest > 0) figures.reciprocity /= figures.largest, figures.anisotropy /= figures.largest;
    return figures;
}

}  // namespace umbra
