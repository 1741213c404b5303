// Wavefront OBJ with its MTL material files, as a scene without camera and lights.
//
// Read here and not by a library, since those at hand take "v 1 abc 2" for a vertex and face corners that are not
// there for others: to name the line of every fault, each line must be read anyway.
#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/file_normals.h"
#include "umbra/core/io/ignored_lines.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/mtl.h"
#include "umbra/core/io/polygon.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/tokens.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

using std::filesystem::path;

constexpr std::uint32_t kNone = 0xffffffffu;
static_assert(kMaxVertices < kNone);

struct Corner {
    std::uint32_t position = 0;
    std::uint32_t normal   = kNone;
};

// One face: its corners lie in a common array. Indices from the file's beginning may name what comes later in it, so
// they are checked at the end, and need the position for that.
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
    FileNormals normal_check;
    std::uint32_t texture_points = 0;
    std::vector<Corner> corners;
    std::vector<Face> faces;
    std::vector<Group> groups;
    std::vector<Token> libraries;
    IgnoredLines skipped;
};

// An index as the file counts: from 1, or backwards from -1 for the last one so far.
std::uint32_t read_index(const Tokens& tokens, Token token, std::string_view digits, std::size_t count,
                         std::string_view what) {
    const Token part{digits, token.offset + std::size_t(digits.data() - token.text.data())};
    const std::int64_t i = tokens.as_integer(part, fmt::format("the {} index", what));
    if (i == 0) tokens.fail(part, fmt::format("the {} index is 0 (they count from 1, or backwards from -1)", what));
    if (i < 0 && std::uint64_t(-(i + 1)) >= count)
        tokens.fail(part, fmt::format("the {} index is {}, but only {} come before", what, i, count));
    if (i > std::int64_t(kMaxVertices))
        tokens.fail(part, fmt::format("the {} index is {}, which no file reaches", what, i));
    return i > 0 ? std::uint32_t(i - 1) : std::uint32_t(std::int64_t(count) + i);
}

// "v", "v/t", "v/t/n" or "v//n".
Corner read_corner(const Tokens& tokens, Token token, const Obj& obj) {
    std::array<std::string_view, 3> parts;
    std::size_t n = 0;
    for (std::string_view rest = token.text;;) {
        const std::size_t slash = rest.find('/');
        parts[n++]              = rest.substr(0, slash);
        if (slash == rest.npos) break;
        if (n == 3)
            tokens.fail(token,
                        fmt::format("the face corner is {}, expected v, v/t, v//n or v/t/n", in_quotes(token.text)));
        rest = rest.substr(slash + 1);
    }
    Corner corner;
    corner.position = read_index(tokens, token, parts[0], obj.positions.size(), "vertex");
    // Texture points have no meaning here, and exporters write 0 for "none": only what is no number at all is refused.
    if (n > 1 && !parts[1].empty()) {
        const std::size_t at = token.offset + std::size_t(parts[1].data() - token.text.data());
        (void)tokens.as_integer({parts[1], at}, "the texture index");
    }
    if (n > 2) corner.normal = read_index(tokens, token, parts[2], obj.normals.size(), "normal");
    return corner;
}

void read_face(Tokens& tokens, Token keyword, Obj& obj, std::uint32_t group) {
    Face face{keyword.offset, std::uint32_t(obj.corners.size()), 0, group};
    while (const Token token = tokens.next_on_line()) {
        obj.corners.push_back(read_corner(tokens, token, obj));
        ++face.count;
    }
    if (face.count < 3)
        tokens.fail(keyword, fmt::format("a face with {} {}, expected at least 3", face.count,
                                         face.count == 1 ? "corner" : "corners"));
    obj.faces.push_back(face);
}

Obj read_lines(const SourceText& source) {
    Obj obj;
    Tokens tokens(source);
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

    for (; !tokens.at_end(); tokens.skip_line()) {
        const Token keyword        = tokens.next();
        const std::string_view key = keyword.text;
        if (key == "v") {
            obj.positions.push_back(tokens.point_on_line("a vertex coordinate"));
        } else if (key == "vn") {
            obj.normals.push_back(obj.normal_check.usable(tokens.normal_on_line()));
        } else if (key == "vt") {
            while (const Token token = tokens.next_on_line()) (void)tokens.as_real(token, "a texture coordinate");
        } else if (key == "f" || key == "fo") {
            read_face(tokens, keyword, obj, group());
        } else if (key == "o" || key == "g" || key == "usemtl") {
            (key == "o" ? object : key == "g" ? group_name : material) = tokens.rest_of_line().text;
            current                                                    = kNone;
        } else if (key == "s") {
            const Token token = tokens.next_on_line();
            smooth            = token.text != "off" && tokens.as_integer(token, "the smoothing group") != 0;
            current           = kNone;
        } else if (key == "mtllib") {
            if (const Token name = tokens.rest_of_line()) obj.libraries.push_back(name);
        } else if (key == "l" || key == "p") {
            obj.skipped.add(key == "l" ? "lines are" : "points are", tokens.line());
        } else {
            obj.skipped.add(fmt::format("the statement {} is", in_quotes(key)), tokens.line());
        }
        if (obj.positions.size() > kMaxVertices || obj.normals.size() > kMaxVertices ||
            obj.corners.size() > kMaxVertices)
            tokens.fail(keyword, fmt::format("more than {} vertices, normals or corners", kMaxVertices));
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
    for (const Token& library : obj.libraries) {
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
            warnings.push_back(fmt::format("{}: the material file {} does not exist: its materials are grey.",
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
        throw InputError(fmt::format("{}: holds no faces, expected lines \"v x y z\" and \"f 1 2 3\"", source.file));
    SceneFile read;
    Scene& scene = read.scene;
    obj.skipped.warn(source.file, scene.warnings);
    obj.normal_check.warn(scene.warnings);

    std::map<std::string, Material, std::less<>> library;
    const bool found = read_libraries(obj, file, source, library, scene.warnings);
    if (!library.empty()) {
        scene.ambient = vec3(0.1f);
        scene.warnings.push_back("MTL files have no ambient light: I_a = 0.1 is assumed.");
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
                    scene.warnings.push_back(
                        fmt::format("{}: no material file describes {}: it is grey.", source.file, in_quotes(name)));
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
            fmt::format("{}: {} polygons cross themselves: they were triangulated as fans.", source.file, crossing));
    return read;
}

}  // namespace umbra
