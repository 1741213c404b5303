// Wavefront OBJ with its MTL material files, as a scene without camera and lights.
//
// Read here and not by a library, since those at hand take "v 1 abc 2" for a vertex and face corners that are not
// there for others: to name the line of every fault, each line must be read anyway.
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <unordered_map>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"
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

// One face: its corners lie in a common array. Indices from the file's beginning may name positions that come later in
// it, so they are checked at the end, and need the position for that.
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
    // Texture points have no meaning here, and exporters write 0 for "none": only text that is not a number is refused.
    if (n > 1 && !parts[1].empty()) {
        const std::size_t at = token.offset + std::size_t(parts[1].data() - token.text.data());
        (void)tokens.as_integer({parts[1], at}, "the texture index");
    }
    if (n > 2 && !parts[2].empty() && parts[2] != "0")
        corner.normal = read_index(tokens, token, parts[2], obj.normals.size(), "normal");
    return corner;
}

void read_face(Tokens& tokens, Token keyword, Obj& obj, std::uint32_t group) {
    Face face{keyword.offset, std::uint32_t(obj.corners.size()), 0, group};
    while (const Token token = tokens.next_on_line()) {
        obj.corners.push_back(read_corner(tokens, token, obj));
        ++face.count;
    }
    if (face.count >= 3) return obj.faces.push_back(face);
    obj.skipped.add("faces of fewer than 3 corners are", tokens.line());
    obj.corners.resize(face.first);
}

// The terms that may follow a position: a weight w, a colour, or both.
void note_terms_of_vertex(Tokens& tokens, IgnoredLines& skipped) {
    const Token first = tokens.next_on_line();
    if (!first) return;
    std::size_t n = 1;
    while (tokens.next_on_line()) ++n;
    const bool is_one =
        first.text == "1" || (first.text.starts_with("1.") && first.text.find_first_not_of('0', 2) == first.text.npos);
    if (n >= 3)
        skipped.add("the colour of a vertex is", tokens.line());
    else if (!is_one)
        skipped.add("the weight w of a vertex is", tokens.line());
}

Obj read_lines(const SourceText& source, const Reading& reading) {
    Obj obj;
    Tokens tokens(source, 0, true);
    // A group is the faces between lines that change object, group, material or smoothing; coming back to an earlier
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
            tokens.refuse_decimal_commas("a vertex coordinate");
            obj.positions.push_back(reading.position(tokens.point_on_line("a vertex coordinate")));
            note_terms_of_vertex(tokens, obj.skipped);
        } else if (key == "vn") {
            tokens.refuse_decimal_commas("a component of a normal");
            obj.normals.push_back(reading.normal(obj.normal_check.usable(tokens.normal_on_line())));
        } else if (key == "vt") {
            while (const Token token = tokens.next_on_line()) (void)tokens.as_any_real(token, "a texture coordinate");
        } else if (key == "f" || key == "fo") {
            read_face(tokens, keyword, obj, group());
        } else if (key == "o" || key == "g" || key == "usemtl") {
            (key == "o" ? object : key == "g" ? group_name : material) = tokens.rest_of_line().text;
            current                                                    = kNone;
        } else if (key == "s") {
            const Token token = tokens.next_on_line();
            smooth            = token && token.text != "0" && lowered(token.text) != "off";
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

// The names in a line of several: quotes hold one together, and so does a backslash before a blank.
std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    bool quoted = false, in_word = false;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const bool escaped = text[k] == '\\' && k + 1 < text.size() && text[k + 1] == ' ';
        if (text[k] == '"') {
            quoted = !quoted;
        } else if (text[k] == ' ' && !quoted) {
            in_word = false;
        } else {
            if (!in_word) words.emplace_back();
            in_word = true;
            words.back() += escaped ? text[++k] : text[k];
        }
    }
    return words;
}

// A # behind a blank may begin a comment or belong to the name ("Material #25").
std::string_view before_comment(std::string_view name) {
    std::size_t hash = name.find('#');
    while (hash != name.npos && hash > 0 && name[hash - 1] != ' ' && name[hash - 1] != '\t')
        hash = name.find('#', hash + 1);
    name = name.substr(0, hash);
    while (!name.empty() && (name.back() == ' ' || name.back() == '\t')) name.remove_suffix(1);
    return name;
}

// The regular file of that name; where there is none, the first of those whose names differ in case alone.
path find_in_any_case(const path& file) {
    if (is_file(file)) return file;
    std::error_code error;
    const std::string wanted = lowered(file.filename().string());
    path found;
    for (std::filesystem::directory_iterator entry(file.parent_path().empty() ? "." : file.parent_path(), error), end;
         !error && entry != end; entry.increment(error))
        if (lowered(entry->path().filename().string()) == wanted && is_file(entry->path()) &&
            (found.empty() || entry->path() < found))
            found = entry->path();
    return found;
}

// The material files, looked for beside the OBJ. A line may name several, and names may hold blanks.
bool read_libraries(const Obj& obj, const path& file, const SourceText& source,
                    std::map<std::string, Material, std::less<>>& materials, std::vector<std::string>& warnings) {
    bool found      = false;
    const auto read = [&](std::string name) {
        std::replace(name.begin(), name.end(), '\\', '/');
        for (const path& beside : {path(name).relative_path(), path(name).filename()}) {
            const path candidate = beside.empty() ? path() : find_in_any_case(file.parent_path() / beside);
            if (candidate.empty()) continue;
            read_mtl(candidate, materials, warnings);
            return found = true;
        }
        return false;
    };
    std::set<std::string_view> tried;
    for (const Token& library : obj.libraries) {
        if (!tried.insert(library.text).second) continue;
        if (read(std::string(library.text)) || read(std::string(before_comment(library.text)))) continue;
        const std::vector<std::string> words = words_of(before_comment(library.text));
        std::vector<std::string> missing;
        for (const std::string& word : words)
            if (!read(word)) missing.push_back(word);
        if (missing.size() == words.size()) missing = {std::string(library.text)};
        for (const std::string& name : missing)
            warnings.push_back(fmt::format("{}: the material file {} does not exist: its materials are grey.",
                                           source.file, in_quotes(name)));
    }
    return found;
}

// The name of the material that a "usemtl" means: either it or "newmtl" may have a comment behind it.
std::string material_named(const std::string& name, const std::map<std::string, Material, std::less<>>& library) {
    const std::string_view bare = before_comment(name);
    if (library.contains(name)) return name;
    if (library.contains(bare)) return std::string(bare);
    for (const auto& [known, material] : library)
        if (before_comment(known) == name) return known;
    return name;
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

SceneFile read_obj(const path& file, const Reading& reading) {
    const SourceText source = read_text(file);
    const Obj obj           = read_lines(source, reading);
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
    const auto material = [&](const std::string& written) {
        const std::string name = material_named(written, library);
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
