// Wavefront OBJ with its MTL material files, as a scene without camera and lights.
//
// Read here and not by a library, since those at hand take "v 1 abc 2" for a vertex and face corners that are not
// there for others: to name the line of every fault, each line must be read anyway.
//
//   MTL            Material
//   Ka             k_a (Kd where the file has none); with materials from a file I_a is 0.1, which the formats lack
//   Kd             k_d
//   Ks             k_s, from illum 2 on (and where there is no illum)
//   Ns             shininess
//   Ke             emission
//   d, 1 - Tr      opacity
//   Ni             index_of_refraction
//   illum 0        Kd is the colour in any light: emission Kd, all else 0
//   illum 3, 5, 8  mirrors: reflect is the largest of Ks
//   illum 4, 6, 7, 9  glass: the same, and transmit is 1 - d
//   map_..., bump  not read, one warning
#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/polygon.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/text_words.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

using std::filesystem::path;

constexpr std::uint32_t kNone = 0xffffffffu;

// Lines that are legal, but mean nothing here: told once per kind of line.
struct Skipped {
    struct Kind {
        std::size_t first_line = 0;
        std::size_t count      = 0;
    };
    std::map<std::string, Kind, std::less<>> kinds;

    void add(std::string_view what, std::size_t line) {
        auto it = kinds.find(what);
        if (it == kinds.end() && kinds.size() >= 20) it = kinds.try_emplace("others").first;
        if (it == kinds.end()) it = kinds.try_emplace(std::string(what)).first;
        if (it->second.count++ == 0) it->second.first_line = line;
    }
    void tell(const std::string& file, std::vector<std::string>& warnings) const {
        for (const auto& [what, kind] : kinds)
            warnings.push_back(fmt::format("{}:{}: {} ignored{}.", file, kind.first_line, what,
                                           kind.count > 1 ? fmt::format(", {} times", kind.count) : ""));
    }
};

// ---- MTL ----

struct MtlMaterial {
    Material material;
    bool has_ka = false;
    int illum   = 2;
};

// "Kd r g b" or "Kd r". Curves of spectra and CIE colours are not read: false.
bool read_colour(Words& words, std::string_view what, vec3& colour) {
    const Word first = words.next_on_line();
    if (first.text == "spectral" || first.text == "xyz") return false;
    colour            = vec3(words.as_real(first, what));
    const Word second = words.next_on_line();
    if (!second) return true;
    colour.g = words.as_real(second, what);
    colour.b = words.real_on_line(what);
    for (int k = 0; k < 3; ++k)
        if (colour[k] < 0) words.fail(first, fmt::format("{} is negative (at least 0 would be right)", what));
    return true;
}

float read_share(Words& words, std::string_view what) {
    Word word = words.next_on_line();
    if (word.text == "-halo") word = words.next_on_line();
    const float x = words.as_real(word, what);
    if (x < 0 || x > 1)
        words.fail(word, fmt::format("{} is {} (a number from 0 to 1 would be right)", what, in_quotes(word.text)));
    return x;
}

Material finished(MtlMaterial m) {
    Material& out = m.material;
    if (!m.has_ka) out.k_a = out.k_d;
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
            break;
        default: break;
    }
    return out;
}

void read_mtl(const path& file, std::map<std::string, Material, std::less<>>& materials,
              std::vector<std::string>& warnings) {
    const SourceText source = read_text(file);
    Words words(source);
    Skipped skipped;
    MtlMaterial current;
    bool open        = false;
    const auto close = [&] {
        if (open) materials[current.material.name] = finished(current);
    };
    for (; !words.at_end(); words.skip_line()) {
        const Word keyword         = words.next();
        const std::string_view key = keyword.text;
        if (key == "newmtl") {
            close();
            const Word name = words.rest_of_line();
            if (!name) words.fail(name, "newmtl without a name (\"newmtl NAME\" would be right)");
            current               = MtlMaterial{};
            current.material.name = name.text;
            current.material.k_d  = vec3(0.8f);
            open                  = true;
            continue;
        }
        static constexpr std::array kKnown = {"Ka", "Kd", "Ks", "Ke", "Ns", "Ni", "d", "Tr", "illum"};
        if (std::find(kKnown.begin(), kKnown.end(), key) == kKnown.end()) {
            const bool texture = key.starts_with("map_") || key == "bump" || key == "disp" || key == "decal" ||
                                 key == "refl" || key == "norm";
            skipped.add(texture ? "textures are" : fmt::format("the term {} is", in_quotes(key)), words.line());
            continue;
        }
        if (!open) words.fail(keyword, fmt::format("{} before any newmtl (\"newmtl NAME\" would be right)", key));
        Material& m = current.material;
        bool read   = true;
        if (key == "Ka") {
            read           = read_colour(words, "Ka", m.k_a);
            current.has_ka = read;
        } else if (key == "Kd") {
            read = read_colour(words, "Kd", m.k_d);
        } else if (key == "Ks") {
            read = read_colour(words, "Ks", m.k_s);
        } else if (key == "Ke") {
            read = read_colour(words, "Ke", m.emission);
        } else if (key == "Ns") {
            const Word word = words.next_on_line();
            m.shininess     = words.as_real(word, "Ns");
            if (m.shininess < 0) words.fail(word, "Ns is negative (at least 0 would be right)");
        } else if (key == "Ni") {
            const Word word       = words.next_on_line();
            m.index_of_refraction = words.as_real(word, "Ni");
            if (m.index_of_refraction <= 0) words.fail(word, "Ni is not positive");
        } else if (key == "d") {
            m.opacity = read_share(words, "d");
        } else if (key == "Tr") {
            m.opacity = 1 - read_share(words, "Tr");
        } else {
            const Word word  = words.next_on_line();
            const auto illum = words.as_integer(word, "illum");
            if (illum < 0 || illum > 10) words.fail(word, "illum is an unknown model (0 to 10 would be right)");
            current.illum = int(illum);
        }
        if (!read) skipped.add(fmt::format("a spectral or CIE {} is", key), words.line());
    }
    close();
    skipped.tell(file.string(), warnings);
}

// ---- OBJ ----

struct Corner {
    std::uint32_t position = 0;
    std::uint32_t normal   = kNone;
};

// One face: its corners lie in a common array. Indices from the file's beginning may name what comes later in it, so
// they are checked at the end, and need the place for that.
struct Face {
    std::size_t offset  = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t group = 0;
};

struct Group {
    std::string name;
    std::string material;
    bool smooth = false;
};

struct Obj {
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::uint32_t texture_points = 0;
    std::vector<Corner> corners;
    std::vector<Face> faces;
    std::vector<Group> groups;
    std::vector<Word> libraries;
    Skipped skipped;
};

// An index as the file counts: from 1, or backwards from -1 for the last one so far.
std::uint32_t read_index(const Words& words, Word word, std::string_view digits, std::size_t count,
                         std::string_view what) {
    const Word part{digits, word.offset + std::size_t(digits.data() - word.text.data())};
    const std::int64_t i = words.as_integer(part, fmt::format("the {} index", what));
    if (i == 0) words.fail(part, fmt::format("the {} index is 0 (they count from 1, or backwards from -1)", what));
    if (i < 0 && std::uint64_t(-(i + 1)) >= count)
        words.fail(part, fmt::format("the {} index is {}, but only {} come before", what, i, count));
    if (i > std::int64_t(kNone) - 1)
        words.fail(part, fmt::format("the {} index is {}, which no file reaches", what, i));
    return i > 0 ? std::uint32_t(i - 1) : std::uint32_t(std::int64_t(count) + i);
}

// "v", "v/t", "v/t/n" or "v//n".
Corner read_corner(const Words& words, Word word, const Obj& obj) {
    std::array<std::string_view, 3> parts;
    std::size_t n = 0;
    for (std::string_view rest = word.text;;) {
        const std::size_t slash = rest.find('/');
        parts[n++]              = rest.substr(0, slash);
        if (slash == rest.npos) break;
        if (n == 3)
            words.fail(word, fmt::format("the face corner is {} (v, v/t, v//n or v/t/n would be right)",
                                         in_quotes(word.text)));
        rest = rest.substr(slash + 1);
    }
    Corner corner;
    corner.position = read_index(words, word, parts[0], obj.positions.size(), "vertex");
    // Texture points have no meaning here, and exporters write 0 for "none": only what is no number at all is refused.
    if (n > 1 && !parts[1].empty()) {
        const std::size_t at = word.offset + std::size_t(parts[1].data() - word.text.data());
        (void)words.as_integer({parts[1], at}, "the texture index");
    }
    if (n > 2) corner.normal = read_index(words, word, parts[2], obj.normals.size(), "normal");
    return corner;
}

void read_face(Words& words, Word keyword, Obj& obj, std::uint32_t group) {
    Face face{keyword.offset, std::uint32_t(obj.corners.size()), 0, group};
    while (const Word word = words.next_on_line()) {
        obj.corners.push_back(read_corner(words, word, obj));
        ++face.count;
    }
    if (face.count < 3)
        words.fail(keyword, fmt::format("a face with {} {} (at least 3 would be right)", face.count,
                                        face.count == 1 ? "corner" : "corners"));
    obj.faces.push_back(face);
}

Obj read_lines(const SourceText& source) {
    Obj obj;
    Words words(source);
    // A group is what lies between lines that change object, group, material or smoothing; coming back to an earlier
    // combination goes on with its group.
    std::string object, group_name, material;
    bool smooth           = false;
    std::uint32_t current = kNone;
    std::map<std::array<std::string, 4>, std::uint32_t> known;
    const auto group = [&] {
        if (current != kNone) return current;
        const auto [it, added] =
            known.try_emplace({object, group_name, material, smooth ? "s" : ""}, std::uint32_t(obj.groups.size()));
        if (added) {
            const std::string name = object.empty()                                  ? group_name
                                     : group_name.empty() || group_name == "default" ? object
                                                                                     : object + "/" + group_name;
            obj.groups.push_back({name, material, smooth});
        }
        return current = it->second;
    };

    for (; !words.at_end(); words.skip_line()) {
        const Word keyword         = words.next();
        const std::string_view key = keyword.text;
        if (key == "v") {
            obj.positions.push_back(words.point_on_line("a vertex coordinate"));
        } else if (key == "vn") {
            obj.normals.push_back(words.point_on_line("a component of a normal"));
        } else if (key == "vt") {
            while (const Word word = words.next_on_line()) (void)words.as_real(word, "a texture coordinate");
        } else if (key == "f" || key == "fo") {
            read_face(words, keyword, obj, group());
        } else if (key == "o" || key == "g" || key == "usemtl") {
            (key == "o" ? object : key == "g" ? group_name : material) = words.rest_of_line().text;
            current                                                    = kNone;
        } else if (key == "s") {
            const Word word = words.next_on_line();
            smooth          = word.text != "off" && words.as_integer(word, "the smoothing group") != 0;
            current         = kNone;
        } else if (key == "mtllib") {
            if (const Word name = words.rest_of_line()) obj.libraries.push_back(name);
        } else if (key == "l" || key == "p") {
            obj.skipped.add(key == "l" ? "lines are" : "points are", words.line());
        } else {
            obj.skipped.add(fmt::format("the statement {} is", in_quotes(key)), words.line());
        }
        if (obj.positions.size() >= kNone || obj.normals.size() >= kNone || obj.corners.size() >= kNone)
            words.fail(keyword, "more than four thousand million vertices or corners");
    }
    for (const Face& face : obj.faces) {
        for (std::uint32_t k = 0; k < face.count; ++k) {
            const Corner& corner = obj.corners[face.first + k];
            const auto check     = [&](std::uint32_t i, std::size_t count, std::string_view what) {
                if (i < count) return;
                source.fail(face.offset, fmt::format("corner {} of the face names {} {}, but the file has {}", k + 1,
                                                         what, std::uint64_t(i) + 1, count));
            };
            check(corner.position, obj.positions.size(), "vertex");
            if (corner.normal != kNone) check(corner.normal, obj.normals.size(), "normal");
        }
    }
    return obj;
}

// The material files, looked for beside the OBJ. A line may name several, and names may hold blanks.
bool read_libraries(const Obj& obj, const path& file, const SourceText& source,
                    std::map<std::string, Material, std::less<>>& materials, std::vector<std::string>& warnings) {
    bool found      = false;
    const auto read = [&](std::string name) {
        std::replace(name.begin(), name.end(), '\\', '/');
        for (const path& candidate :
             {file.parent_path() / path(name).relative_path(), file.parent_path() / path(name).filename()}) {
            std::error_code error;
            if (!std::filesystem::is_regular_file(candidate, error)) continue;
            read_mtl(candidate, materials, warnings);
            return true;
        }
        return false;
    };
    std::map<std::string_view, bool> tried;
    for (const Word& library : obj.libraries) {
        if (!tried.try_emplace(library.text, true).second) continue;
        bool here = read(std::string(library.text));
        for (std::size_t begin = 0;
             !here && library.text.find(' ') != library.text.npos && begin < library.text.size();) {
            const std::size_t end = std::min(library.text.find(' ', begin), library.text.size());
            if (end > begin && read(std::string(library.text.substr(begin, end - begin)))) found = true;
            begin = end + 1;
        }
        found = found || here;
        if (!found)
            warnings.push_back(fmt::format("{}: the material file {} is not there: its materials are taken as grey.",
                                           source.file, in_quotes(library.text)));
    }
    return found;
}

// The faces of one group as a mesh with the positions that they use; a position with several normals is split.
Mesh mesh_of(const Obj& obj, const std::vector<std::uint32_t>& faces, std::size_t& crossing) {
    Mesh mesh;
    bool any_normal = false;
    std::unordered_map<std::uint64_t, std::uint32_t> local;
    std::vector<std::uint32_t> polygon;
    for (const std::uint32_t f : faces) {
        const Face& face = obj.faces[f];
        polygon.clear();
        for (std::uint32_t k = 0; k < face.count; ++k) {
            const Corner& corner   = obj.corners[face.first + k];
            const auto [it, added] = local.try_emplace(std::uint64_t(corner.position) << 32 | corner.normal,
                                                       std::uint32_t(mesh.positions.size()));
            if (added) {
                mesh.positions.push_back(obj.positions[corner.position]);
                mesh.normals.push_back(corner.normal == kNone ? vec3(0) : obj.normals[corner.normal]);
                any_normal = any_normal || corner.normal != kNone;
            }
            polygon.push_back(it->second);
        }
        if (!triangulate(mesh.positions, polygon, mesh.triangles)) ++crossing;
    }
    if (!any_normal) mesh.normals.clear();
    return mesh;
}

}  // namespace

SceneFile read_obj(const path& file) {
    const SourceText source = read_text(file);
    const Obj obj           = read_lines(source);
    if (obj.faces.empty())
        throw InputError(
            fmt::format("{}: holds no faces (lines \"v x y z\" and \"f 1 2 3\" would be right)", source.file));
    SceneFile read;
    Scene& scene = read.scene;
    obj.skipped.tell(source.file, scene.warnings);

    std::map<std::string, Material, std::less<>> library;
    const bool found = read_libraries(obj, file, source, library, scene.warnings);
    if (!library.empty()) {
        scene.ambient = vec3(0.1f);
        scene.warnings.push_back("MTL files know no ambient light: I_a = 0.1 is assumed.");
    }

    std::vector<std::vector<std::uint32_t>> faces_of(obj.groups.size());
    for (std::uint32_t f = 0; f < obj.faces.size(); ++f) faces_of[obj.faces[f].group].push_back(f);

    std::map<std::string, std::uint32_t, std::less<>> material_of;
    const auto material = [&](const std::string& name) {
        const auto [it, added] = material_of.try_emplace(name, std::uint32_t(scene.materials.size()));
        if (added) {
            const auto known = library.find(name);
            Material m;
            if (known != library.end()) {
                m = known->second;
            } else {
                if (!library.empty()) m.k_a = m.k_d;
                if (found && !name.empty())
                    scene.warnings.push_back(fmt::format("{}: no material file describes {}: it is taken as grey.",
                                                         source.file, in_quotes(name)));
            }
            m.name = name.empty() ? "default" : name;
            scene.materials.push_back(std::move(m));
        }
        return it->second;
    };

    std::size_t crossing = 0;
    for (std::size_t g = 0; g < obj.groups.size(); ++g) {
        const Group& group = obj.groups[g];
        Mesh mesh          = mesh_of(obj, faces_of[g], crossing);
        if (group.smooth && mesh.normals.empty()) mesh = with_averaged_normals(mesh);
        const std::string name = group.name.empty() ? file.stem().string() : group.name;
        add_object(scene, name, mesh.positions, mesh.normals, mesh.triangles, material(group.material));
    }
    if (crossing > 0)
        scene.warnings.push_back(
            fmt::format("{}: {} polygons cross themselves: they were cut as fans.", source.file, crossing));
    return read;
}

}  // namespace umbra
