// PLY, OFF and STL: one mesh without material, camera and light.
//
// Read here and not by a library: those at hand take memory for as many vertices as the header claims before they look
// for them, and say nothing of where a fault is. Nothing here is reserved by a number in the file: what is not there
// is missed when its turn comes, and what is held is never larger than the file by more than a constant factor.
//
// Greg Turk. The PLY Polygon File Format. 1994
// Stuart Levy, Tamara Munzner, Mark Phillips. Geomview's Object File Format. 1991
// 3D Systems. StereoLithography Interface Specification. 1989
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/polygon.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/text_words.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

using std::filesystem::path;

constexpr std::uint64_t kMaxVertices = 0xfffffffeu;

struct Part {
    std::string name;
    Mesh mesh;
    std::size_t crossing = 0;  ///< polygons that cross themselves

    void add_polygon(std::span<const std::uint32_t> polygon) {
        if (!triangulate(mesh.positions, polygon, mesh.triangles)) ++crossing;
    }
};

// ---- OFF ----

// The ending of a header keyword's prefixes: texture points, colours and normals that follow each vertex.
Part read_off(const SourceText& source) {
    Words words(source);
    const Word header     = words.next();
    const std::size_t end = header.text.size();
    if (!header.text.ends_with("OFF") || header.text.substr(0, end - 3).find_first_not_of("STCN") != header.text.npos)
        words.fail(header,
                   fmt::format("the file begins with {} (OFF, or with any of ST, C, N before it, would be right)",
                               in_quotes(header.text)));
    const bool has_normals = header.text.find('N') != header.text.npos;

    Word first = words.next_on_line();
    if (!first) first = words.next();
    if (first.text == "BINARY") words.fail(first, "binary OFF is not read (text would be right)");
    const auto count = [&](Word word, std::string_view what) {
        const auto n = words.as_integer(word, what);
        if (n < 0 || std::uint64_t(n) > kMaxVertices)
            words.fail(word, fmt::format("{} is {} (0 to {} would be right)", what, n, kMaxVertices));
        return std::uint64_t(n);
    };
    const std::uint64_t vertices = count(first, "the number of vertices");
    const Word faces_word        = words.next_on_line();
    const std::uint64_t faces    = count(faces_word, "the number of faces");
    (void)count(words.next_on_line(), "the number of edges");
    // A vertex takes at least "0 0 0" and a blank, a face "0" and a blank.
    const std::size_t left = source.text.size() - words.offset() + 1;
    if (vertices > left / 6)
        words.fail(first, fmt::format("{} vertices, but only {} bytes follow", vertices, left - 1));
    if (faces > left / 2) words.fail(faces_word, fmt::format("{} faces, but only {} bytes follow", faces, left - 1));

    Part part;
    for (std::uint64_t i = 0; i < vertices; ++i) {
        if (words.at_end()) words.fail(words.next(), fmt::format("the file ends after {} of {} vertices", i, vertices));
        part.mesh.positions.push_back(words.point("a vertex coordinate"));
        if (has_normals) part.mesh.normals.push_back(words.point("a component of a normal"));
        while (const Word extra = words.next_on_line()) (void)words.as_real(extra, "a colour or texture coordinate");
    }
    std::vector<std::uint32_t> polygon;
    for (std::uint64_t i = 0; i < faces; ++i) {
        const Word word = words.next();
        if (!word) words.fail(word, fmt::format("the file ends after {} of {} faces", i, faces));
        const auto n = words.as_integer(word, "the number of corners");
        if (n < 3) words.fail(word, fmt::format("a face of {} corners (at least 3 would be right)", n));
        polygon.clear();
        for (std::int64_t k = 0; k < n; ++k) {
            const Word corner = words.next();
            if (!corner) words.fail(corner, fmt::format("the file ends within a face of {} corners", n));
            const auto v = words.as_integer(corner, "the vertex index");
            if (v < 0 || std::uint64_t(v) >= vertices)
                words.fail(corner, fmt::format("vertex index {} (there are {}, counted from 0)", v, vertices));
            polygon.push_back(std::uint32_t(v));
        }
        part.add_polygon(polygon);
        words.skip_line();  // a colour may follow
    }
    return part;
}

// ---- binary files ----

// Bytes in order, each take checked against the end.
class Bytes {
public:
    Bytes(const SourceText& source, std::size_t begin, bool big_endian)
        : source_(source), at_(begin), swap_(big_endian == (std::endian::native == std::endian::little)) {}

    [[nodiscard]] std::size_t left() const { return source_.text.size() - at_; }
    [[nodiscard]] std::size_t offset() const { return at_; }
    [[noreturn]] void fail(std::size_t offset, std::string_view message) const {
        throw InputError(fmt::format("{}: byte {}: {}", source_.file, offset, message));
    }
    void skip(std::uint64_t n, std::string_view what) {
        need(n, what);
        at_ += std::size_t(n);
    }
    template <class T>
    T take(std::string_view what) {
        need(sizeof(T), what);
        std::array<char, sizeof(T)> raw;
        std::memcpy(raw.data(), source_.text.data() + at_, sizeof(T));
        if (swap_) std::reverse(raw.begin(), raw.end());
        at_ += sizeof(T);
        return std::bit_cast<T>(raw);
    }

private:
    void need(std::uint64_t n, std::string_view what) const {
        if (left() < n) fail(at_, fmt::format("the file ends within {}", what));
    }

    const SourceText& source_;
    std::size_t at_;
    bool swap_;
};

float checked(const Bytes& bytes, std::size_t offset, double x, std::string_view what) {
    if (!std::isfinite(x) || std::abs(x) > kMaxCoordinate)
        bytes.fail(offset, fmt::format("{} is {:g} (a finite number of magnitude up to {:g} would be right)", what, x,
                                       kMaxCoordinate));
    return static_cast<float>(x);
}

// ---- PLY ----

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type     = PlyType::float32;
    bool is_list     = false;
    PlyType counting = PlyType::uint8;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

enum class PlyFormat : std::uint8_t { ascii, little, big };

PlyType ply_type(const Words& words, Word word) {
    static constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{{"char", PlyType::int8},
                                                                                  {"int8", PlyType::int8},
                                                                                  {"uchar", PlyType::uint8},
                                                                                  {"uint8", PlyType::uint8},
                                                                                  {"short", PlyType::int16},
                                                                                  {"int16", PlyType::int16},
                                                                                  {"ushort", PlyType::uint16},
                                                                                  {"uint16", PlyType::uint16},
                                                                                  {"int", PlyType::int32},
                                                                                  {"int32", PlyType::int32},
                                                                                  {"uint", PlyType::uint32},
                                                                                  {"uint32", PlyType::uint32},
                                                                                  {"float", PlyType::float32},
                                                                                  {"float32", PlyType::float32},
                                                                                  {"double", PlyType::float64},
                                                                                  {"float64", PlyType::float64}}};
    for (const auto& [name, type] : kTypes)
        if (word.text == name) return type;
    words.fail(word, fmt::format("unknown type {} (known: char uchar short ushort int uint float double)",
                                 in_quotes(word.text)));
}

std::size_t size_of(PlyType type) {
    static constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[std::size_t(type)];
}

bool is_whole(PlyType type) { return type < PlyType::float32; }

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::size_t end = 0;  ///< where the data begins
};

PlyHeader read_ply_header(const SourceText& source) {
    Words words(source);
    PlyHeader header;
    const Word magic = words.next();
    if (magic.text != "ply")
        words.fail(magic, fmt::format("the file begins with {} (ply would be right)", in_quotes(magic.text)));
    words.skip_line();
    bool has_format = false;
    for (;; words.skip_line()) {
        const Word keyword         = words.next();
        const std::string_view key = keyword.text;
        if (!keyword) words.fail(keyword, "the file ends within the header (\"end_header\" would be right)");
        if (key == "end_header") {
            words.skip_line();
            break;
        }
        if (key == "comment" || key == "obj_info") continue;
        if (key == "format") {
            const Word word = words.next_on_line();
            if (word.text == "ascii")
                header.format = PlyFormat::ascii;
            else if (word.text == "binary_little_endian")
                header.format = PlyFormat::little;
            else if (word.text == "binary_big_endian")
                header.format = PlyFormat::big;
            else
                words.fail(word, fmt::format("unknown format {} (known: ascii binary_little_endian binary_big_endian)",
                                             in_quotes(word.text)));
            has_format = true;
        } else if (key == "element") {
            PlyElement element;
            const Word name = words.next_on_line();
            if (!name) words.fail(name, "an element without a name");
            element.name     = name.text;
            const Word count = words.next_on_line();
            const auto n     = words.as_integer(count, "the number of elements");
            if (n < 0 || std::uint64_t(n) > kMaxVertices)
                words.fail(count,
                           fmt::format("the number of elements is {} (0 to {} would be right)", n, kMaxVertices));
            element.count = std::uint64_t(n);
            header.elements.push_back(std::move(element));
        } else if (key == "property") {
            if (header.elements.empty()) words.fail(keyword, "a property before any element");
            PlyProperty property;
            Word type = words.next_on_line();
            if (type.text == "list") {
                const Word counting = words.next_on_line();
                property.is_list    = true;
                property.counting   = ply_type(words, counting);
                if (!is_whole(property.counting)) words.fail(counting, "a list counted by fractions");
                type = words.next_on_line();
            }
            property.type   = ply_type(words, type);
            const Word name = words.next_on_line();
            if (!name) words.fail(name, "a property without a name");
            property.name = name.text;
            header.elements.back().properties.push_back(std::move(property));
        } else {
            words.fail(keyword, fmt::format("unknown header line {} (known: format element property comment obj_info "
                                            "end_header)",
                                            in_quotes(key)));
        }
    }
    if (!has_format) words.fail({{}, 0}, "the header names no format (\"format ascii 1.0\" would be right)");
    header.end = words.offset();
    return header;
}

// The numbers behind the header, as text or as bytes.
class PlyBody {
public:
    PlyBody(const SourceText& source, const PlyHeader& header)
        : ascii_(header.format == PlyFormat::ascii),
          words_(source, header.end),
          bytes_(source, header.end, header.format == PlyFormat::big) {}

    float real(PlyType type, std::string_view what) {
        if (ascii_) return words_.real(what);
        const std::size_t at = bytes_.offset();
        return checked(bytes_, at, number(type, what), what);
    }
    std::int64_t whole(PlyType type, std::string_view what) {
        last_ = ascii_ ? words_.offset() : bytes_.offset();
        if (!ascii_) return std::int64_t(number(type, what));
        const Word word = words_.next();
        last_           = word.offset;
        return words_.as_integer(word, what);
    }
    /// Blames the number that whole() read last.
    [[noreturn]] void fail(std::string_view message) const {
        if (ascii_) words_.fail({{}, last_}, message);
        bytes_.fail(last_, message);
    }

private:
    double number(PlyType type, std::string_view what) {
        switch (type) {
            case PlyType::int8: return bytes_.take<std::int8_t>(what);
            case PlyType::uint8: return bytes_.take<std::uint8_t>(what);
            case PlyType::int16: return bytes_.take<std::int16_t>(what);
            case PlyType::uint16: return bytes_.take<std::uint16_t>(what);
            case PlyType::int32: return bytes_.take<std::int32_t>(what);
            case PlyType::uint32: return bytes_.take<std::uint32_t>(what);
            case PlyType::float32: return double(bytes_.take<float>(what));
            case PlyType::float64: break;
        }
        return bytes_.take<double>(what);
    }

    bool ascii_;
    Words words_;
    Bytes bytes_;
    std::size_t last_ = 0;
};

// Stanford's strips: -1 begins the next one.
void add_strips(Part& part, const std::vector<std::int64_t>& strip) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < strip.size(); ++i) {
        if (strip[i] < 0) begin = i + 1;
        if (i < begin + 2) continue;
        const std::array<std::uint32_t, 3> t{std::uint32_t(strip[i - 2]), std::uint32_t(strip[i - 1]),
                                             std::uint32_t(strip[i])};
        const bool odd = (i - begin) % 2 != 0;
        part.mesh.triangles.emplace_back(t[odd ? 1 : 0], t[odd ? 0 : 1], t[2]);
    }
}

void read_ply_element(PlyBody& body, const PlyElement& element, Part& part, std::uint64_t vertices) {
    const bool is_vertex = element.name == "vertex";
    const bool is_strips = element.name == "tristrips";
    const bool is_face   = element.name == "face" || is_strips;
    // Which property is which coordinate: x y z nx ny nz, or -1.
    static constexpr std::array<std::string_view, 6> kCoordinates{"x", "y", "z", "nx", "ny", "nz"};
    std::vector<int> role(element.properties.size(), -1);
    std::array<bool, 6> seen{};
    bool has_indices = false;
    for (std::size_t p = 0; p < role.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        for (int k = 0; is_vertex && k < 6; ++k)
            if (!property.is_list && property.name == kCoordinates[std::size_t(k)])
                role[p] = k, seen[std::size_t(k)] = true;
        if (is_face && property.is_list && is_whole(property.type) && !has_indices &&
            (property.name == "vertex_indices" || property.name == "vertex_index"))
            role[p] = 0, has_indices = true;
    }
    if (is_vertex && !(seen[0] && seen[1] && seen[2])) body.fail("the element vertex has no properties x, y and z");
    if (is_face && element.count > 0 && !has_indices)
        body.fail(fmt::format("the element {} has no list vertex_indices of whole numbers", element.name));
    const bool has_normals = seen[3] && seen[4] && seen[5];
    if (role.empty()) return;  // any number of nothing

    std::vector<std::uint32_t> polygon;
    std::vector<std::int64_t> list;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        std::array<float, 6> c{};
        for (std::size_t p = 0; p < role.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            if (!property.is_list) {
                const float x = body.real(property.type, property.name);
                if (role[p] >= 0 && is_vertex) c[std::size_t(role[p])] = x;
                continue;
            }
            const std::int64_t n = body.whole(property.counting, "the length of a list");
            if (n < 0) body.fail(fmt::format("a list of length {} (at least 0 would be right)", n));
            if (role[p] >= 0 && !is_strips && n < 3)
                body.fail(fmt::format("a face of {} corners (at least 3 would be right)", n));
            list.clear();
            for (std::int64_t k = 0; k < n; ++k) {
                if (role[p] < 0) {
                    (void)body.real(property.type, property.name);
                    continue;
                }
                const std::int64_t v = body.whole(property.type, "the vertex index");
                if ((v < 0 && !(is_strips && v == -1)) || (v >= 0 && std::uint64_t(v) >= vertices))
                    body.fail(fmt::format("vertex index {} (there are {}, counted from 0)", v, vertices));
                list.push_back(v);
            }
            if (role[p] < 0) continue;
            if (is_strips) {
                add_strips(part, list);
            } else {
                polygon.assign(list.begin(), list.end());
                part.add_polygon(polygon);
            }
        }
        if (is_vertex) {
            part.mesh.positions.emplace_back(c[0], c[1], c[2]);
            if (has_normals) part.mesh.normals.emplace_back(c[3], c[4], c[5]);
        }
    }
}

Part read_ply(const SourceText& source) {
    const PlyHeader header = read_ply_header(source);
    const auto named  = [](std::string_view name) { return [name](const PlyElement& e) { return e.name == name; }; };
    const auto vertex = std::find_if(header.elements.begin(), header.elements.end(), named("vertex"));
    const auto again =
        vertex == header.elements.end() ? vertex : std::find_if(vertex + 1, header.elements.end(), named("vertex"));
    const std::size_t before = header.end;
    if (vertex == header.elements.end() || again != header.elements.end())
        source.fail(0, "the header has not exactly one element vertex");
    // Faces are checked against the vertices, which come first in all files that anyone writes.
    for (auto e = header.elements.begin(); e != vertex; ++e)
        if (e->name == "face" || e->name == "tristrips") source.fail(0, "faces before their vertices");
    for (const PlyElement& e : header.elements) {
        std::uint64_t least = 0;  // bytes of one element
        for (const PlyProperty& p : e.properties)
            least += header.format == PlyFormat::ascii ? 2 : size_of(p.is_list ? p.counting : p.type);
        const std::uint64_t left = source.text.size() - before + 1;
        if (least > 0 && e.count > left / least)
            source.fail(0, fmt::format("the header says {} of element {}, but only {} bytes follow it", e.count, e.name,
                                       left - 1));
    }
    Part part;
    PlyBody body(source, header);
    for (const PlyElement& e : header.elements) read_ply_element(body, e, part, vertex->count);
    return part;
}

// ---- STL ----

// Facets share no positions and their normals say nothing that their corners do not: they are checked and left out.
std::vector<Part> read_text_stl(const SourceText& source) {
    Words words(source);
    std::vector<Part> parts;
    const auto expect = [&](Word word, std::string_view name) {
        if (word.text != name)
            words.fail(word, fmt::format("{} where \"{}\" would be right",
                                         word ? in_quotes(word.text) : "the end of the file", name));
    };
    while (!words.at_end()) {
        expect(words.next(), "solid");
        Part part;
        part.name = words.rest_of_line().text;
        for (;;) {
            const Word word = words.next();
            if (word.text == "endsolid") {
                (void)words.rest_of_line();
                break;
            }
            if (word.text != "facet")
                words.fail(word, fmt::format("{} where \"facet\" or \"endsolid\" would be right",
                                             word ? in_quotes(word.text) : "the end of the file"));
            expect(words.next(), "normal");
            (void)words.point("a component of a normal");
            expect(words.next(), "outer");
            expect(words.next(), "loop");
            const auto first = std::uint32_t(part.mesh.positions.size());
            for (int k = 0; k < 3; ++k) {
                expect(words.next(), "vertex");
                part.mesh.positions.push_back(words.point("a vertex coordinate"));
            }
            part.mesh.triangles.emplace_back(first, first + 1, first + 2);
            expect(words.next(), "endloop");
            expect(words.next(), "endfacet");
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

constexpr std::size_t kStlHeader = 84, kStlFacet = 50;

std::vector<Part> read_binary_stl(const SourceText& source, std::uint32_t facets) {
    Bytes bytes(source, kStlHeader, false);
    std::vector<Part> parts(1);
    Mesh& mesh = parts[0].mesh;
    for (std::uint32_t i = 0; i < facets; ++i) {
        std::array<float, 12> f;
        for (float& x : f) {
            const std::size_t at = bytes.offset();
            x                    = checked(bytes, at, double(bytes.take<float>("a facet")), "a coordinate of a facet");
        }
        bytes.skip(2, "a facet");
        const auto first = std::uint32_t(mesh.positions.size());
        for (std::size_t k = 3; k < 12; k += 3) mesh.positions.emplace_back(f[k], f[k + 1], f[k + 2]);
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return parts;
}

// Binary files may begin with "solid" too, so the length decides: 80 bytes, the number of facets, 50 bytes each.
std::vector<Part> read_stl(const SourceText& source) {
    const std::size_t size = source.text.size();
    std::uint32_t facets   = 0;
    if (size >= kStlHeader) {
        facets = Bytes(source, kStlHeader - 4, false).take<std::uint32_t>("the header");
        if (size == kStlHeader + std::uint64_t(facets) * kStlFacet) return read_binary_stl(source, facets);
    }
    if (Words(source).next().text == "solid") return read_text_stl(source);
    if (size < kStlHeader)
        throw InputError(
            fmt::format("{}: neither text (\"solid\" at its beginning would be right) nor binary STL ({} "
                        "bytes; at least {} would be right)",
                        source.file, size, kStlHeader));
    throw InputError(fmt::format("{}: byte {}: {} facets take {} bytes, but the file has {}", source.file,
                                 kStlHeader - 4, facets, kStlHeader + std::uint64_t(facets) * kStlFacet, size));
}

}  // namespace

SceneFile read_bare_mesh(const path& file) {
    const SourceText source = read_text(file);
    std::string ending      = file.extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    std::vector<Part> parts;
    if (ending == ".stl")
        parts = read_stl(source);
    else if (ending == ".off")
        parts.push_back(read_off(source));
    else
        parts.push_back(read_ply(source));

    SceneFile read;
    Scene& scene         = read.scene;
    std::size_t crossing = 0;
    scene.materials.emplace_back();
    scene.materials[0].name = "default";
    for (const Part& part : parts) {
        if (part.mesh.triangles.empty()) continue;
        crossing += part.crossing;
        add_object(scene, part.name.empty() ? file.stem().string() : part.name, part.mesh.positions, part.mesh.normals,
                   part.mesh.triangles, 0);
    }
    if (scene.triangles.empty())
        throw InputError(fmt::format("{}: holds no faces (at least one would be right)", source.file));
    if (crossing > 0)
        scene.warnings.push_back(fmt::format("{} polygons cross themselves: they were cut as fans.", crossing));
    return read;
}

}  // namespace umbra
