// MTL, the material files of Wavefront OBJ, as Phong materials.
//
//   MTL            Material
//   Ka             k_a (Kd where the file has none); with materials from a file I_a is 0.1, which the formats lack
//   Kd             k_d
//   Ks             k_s, from illum 2 on (and where there is no illum)
//   Ns             shininess
//   Ke             emission
//   d, 1 - Tr      opacity; d where they contradict, with a warning
//   Ni             index_of_refraction
//   Tf             transmit_colour, where illum has glass; 0 0 0, which some exporters write, is taken as 1 1 1
//   illum 0        Kd is the colour in any light: emission Kd, all else 0
//   illum 3, 5, 8  mirrors: reflect is the largest of Ks
//   illum 4, 6, 7, 9  glass: the same, and transmit is 1 - d
//   map_..., bump  not read, one warning
#include "umbra/core/io/mtl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "umbra/core/io/ignored_lines.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

struct MtlMaterial {
    Material material;
    vec3 filter{1};  ///< Tf
    bool has_ka = false;
    int illum   = 2;
    std::optional<float> d, tr;
};

// "Kd r g b" or "Kd r". Curves of spectra and CIE colours are not read: false.
bool read_colour(Tokens& tokens, std::string_view what, vec3& colour) {
    const Token first = tokens.next_on_line();
    if (first.text == "spectral" || first.text == "xyz") return false;
    colour             = vec3(tokens.as_real(first, what));
    const Token second = tokens.next_on_line();
    if (second) {
        colour.g = tokens.as_real(second, what);
        colour.b = tokens.real_on_line(what);
    }
    for (int k = 0; k < 3; ++k)
        if (colour[k] < 0) tokens.fail(first, fmt::format("{} is negative, expected at least 0", what));
    return true;
}

float read_share(Tokens& tokens, std::string_view what, IgnoredLines& skipped) {
    Token token = tokens.next_on_line();
    if (token.text == "-halo") token = tokens.next_on_line();
    const float x     = tokens.as_real(token, what);
    const float share = std::clamp(x, 0.0f, 1.0f);
    if (share != x) skipped.add(fmt::format("what {} has beyond 0 to 1 is", what), tokens.line());
    return share;
}

Material finished(MtlMaterial m) {
    Material& out = m.material;
    if (!m.has_ka) out.k_a = out.k_d;
    out.opacity        = m.d ? *m.d : 1 - m.tr.value_or(0);
    const float mirror = std::min(1.0f, std::max({out.k_s.r, out.k_s.g, out.k_s.b}));
    switch (m.illum) {
        case 0:
            out.emission += out.k_d;
            out.k_a = out.k_d = out.k_s = vec3(0);
            break;
        case 1: out.k_s = vec3(0); break;
        case 3:
        case 5:
        case 8: out.reflect = mirror; break;
        case 4:
        case 6:
        case 7:
        case 9:
            out.reflect  = mirror;
            out.transmit = 1 - out.opacity;
            if (m.filter != vec3(0)) out.transmit_colour = glm::min(m.filter, vec3(1));
            break;
        default: break;
    }
    return out;
}

}  // namespace

void read_mtl(const std::filesystem::path& file, std::map<std::string, Material, std::less<>>& materials,
              std::vector<std::string>& warnings) {
    const SourceText source = read_text(file);
    Tokens tokens(source, 0, true);
    IgnoredLines skipped;
    MtlMaterial current;
    bool open        = false;
    const auto close = [&] {
        if (open) materials[current.material.name] = finished(current);
    };
    for (; !tokens.at_end(); tokens.skip_line()) {
        const Token keyword        = tokens.next();
        const std::string_view key = keyword.text;
        if (key == "newmtl") {
            close();
            const Token name = tokens.rest_of_line();
            if (!name) tokens.fail(name, "newmtl without a name, expected \"newmtl NAME\"");
            current               = MtlMaterial{};
            current.material.name = name.text;
            current.material.k_d  = vec3(0.8f);
            open                  = true;
            continue;
        }
        static constexpr std::array kKnown = {"Ka", "Kd", "Ks", "Ke", "Ns", "Ni", "Tf", "d", "Tr", "illum"};
        if (std::find(kKnown.begin(), kKnown.end(), key) == kKnown.end()) {
            const bool texture = key.starts_with("map_") || key == "bump" || key == "disp" || key == "decal" ||
                                 key == "refl" || key == "norm";
            skipped.add(texture ? "textures are" : fmt::format("the term {} is", in_quotes(key)), tokens.line());
            (void)tokens.rest_of_line();  // a backslash at the end of a path joins nothing
            continue;
        }
        tokens.refuse_decimal_commas(key);
        if (!open) tokens.fail(keyword, fmt::format("{} before any newmtl, expected \"newmtl NAME\"", key));
        Material& m = current.material;
        bool read   = true;
        if (key == "Ka") {
            read           = read_colour(tokens, "Ka", m.k_a);
            current.has_ka = read;
        } else if (key == "Kd") {
            read = read_colour(tokens, "Kd", m.k_d);
        } else if (key == "Ks") {
            read = read_colour(tokens, "Ks", m.k_s);
        } else if (key == "Ke") {
            read = read_colour(tokens, "Ke", m.emission);
        } else if (key == "Ns") {
            const Token token = tokens.next_on_line();
            m.shininess       = tokens.as_real(token, "Ns");
            if (m.shininess < 0) tokens.fail(token, "Ns is negative, expected at least 0");
        } else if (key == "Ni") {
            const Token token = tokens.next_on_line();
            const float index = tokens.as_real(token, "Ni");  // exporters write 0 for none
            if (index != 0 && !kPositive.holds(index))
                tokens.fail(token, fmt::format("Ni is {}, expected {}", in_quotes(token.text), kPositive.words));
            if (index > 0) m.index_of_refraction = index;
        } else if (key == "Tf") {
            read = read_colour(tokens, "Tf", current.filter);
        } else if (key == "d") {
            current.d = read_share(tokens, "d", skipped);
        } else if (key == "Tr") {
            current.tr = read_share(tokens, "Tr", skipped);
        } else {
            const Token token = tokens.next_on_line();
            const float illum = tokens.as_real(token, "illum");
            if (illum >= 0 && illum <= 10 && illum == std::floor(illum))
                current.illum = int(illum);
            else
                skipped.add("an illum that is none of 0 to 10 is", tokens.line());
        }
        if ((key == "d" || key == "Tr") && current.d && current.tr && std::abs(*current.d + *current.tr - 1) > 1e-3f)
            skipped.add("a Tr other than 1 - d is", tokens.line());
        if (!read) skipped.add(fmt::format("a spectral or CIE {} is", key), tokens.line());
    }
    close();
    skipped.warn(file.string(), warnings);
}

}  // namespace umbra
