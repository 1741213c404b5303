// PLY, the Stanford polygon format, as text and as binary of both byte orders.
//
// Greg Turk. The PLY Polygon File Format. 1994
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "umbra/core/io/binary_reader.h"
#include "umbra/core/io/mesh_parts.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

enum class Type : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
    std::string name;
    Type type     = Type::float32;
    bool is_list  = false;
    Type counting = Type::uint8;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

enum class Encoding : std::uint8_t { ascii, little, big };

Type read_type(const Tokens& tokens, Token token) {
    static constexpr std::array<std::pair<std::string_view, Type>, 16> kTypes{{{"char", Type::int8},
                                                                               {"int8", Type::int8},
                                                                               {"uchar", Type::uint8},
                                                                               {"uint8", Type::uint8},
                                                                               {"short", Type::int16},
                                                                               {"int16", Type::int16},
                                                                               {"ushort", Type::uint16},
                                                                               {"uint16", Type::uint16},
                                                                               {"int", Type::int32},
                                                                               {"int32", Type::int32},
                                                                               {"uint", Type::uint32},
                                                                               {"uint32", Type::uint32},
                                                                               {"float", Type::float32},
                                                                               {"float32", Type::float32},
                                                                               {"double", Type::float64},
                                                                               {"float64", Type::float64}}};
    const std::string written = lowered(token.text);
    for (const auto& [name, type] : kTypes)
        if (written == name) return type;
    tokens.fail(token, fmt::format("unknown type {} (known: char uchar short ushort int uint float double)",
                                   in_quotes(token.text)));
}

std::size_t size_of(Type type) {
    static constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[std::size_t(type)];
}

bool is_whole(Type type) { return type < Type::float32; }

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::size_t end = 0;  ///< where the data begins
};

// Words are read in any case. A line of another kind before the first element is left out, as where a program signs its
// name: behind it, a misspelt property would move the columns. Where the first line ends in a CR alone, all lines of
// the header do, so that an LF behind the last one is a byte of the data.
Header read_header(const SourceText& source, std::vector<std::string>& warnings) {
    Tokens tokens(source);
    Header header;
    const Token magic = tokens.next();
    if (lowered(magic.text) != "ply")
        tokens.fail(magic, fmt::format("the file begins with {}, expected ply", in_quotes(magic.text)));
    const std::size_t first_end = line_end(source.text, tokens.offset());
    const bool ends_in_cr       = first_end < source.text.size() && source.text[first_end] == '\r';
    tokens.skip_line();
    bool has_format      = false;
    std::size_t left_out = 0;
    std::string first;
    for (;; tokens.skip_line()) {
        const Token keyword   = tokens.next();
        const std::string key = lowered(keyword.text);
        if (!keyword) tokens.fail(keyword, "the file ends within the header, expected \"end_header\"");
        if (key == "end_header") {
            header.end = std::min(tokens.offset() + 1, source.text.size());
            if (!ends_in_cr) {
                tokens.skip_line();
                header.end = tokens.offset();
            }
            break;
        }
        if (key == "comment" || key == "obj_info") {
            (void)tokens.rest_of_line();  // a backslash at its end joins nothing
            continue;
        }
        if (key == "format") {
            const Token token        = tokens.next_on_line();
            const std::string format = lowered(token.text);
            if (format == "ascii")
                header.encoding = Encoding::ascii;
            else if (format == "binary_little_endian")
                header.encoding = Encoding::little;
            else if (format == "binary_big_endian")
                header.encoding = Encoding::big;
            else
                tokens.fail(token,
                            fmt::format("unknown format {} (known: ascii binary_little_endian binary_big_endian)",
                                        in_quotes(token.text)));
            has_format = true;
        } else if (key == "element") {
            Element element;
            const Token name = tokens.next_on_line();
            if (!name) tokens.fail(name, "an element without a name");
            element.name      = lowered(name.text);
            const Token count = tokens.next_on_line();
            const auto n      = tokens.as_integer(count, "the number of elements");
            if (n < 0 || std::uint64_t(n) > kMaxVertices)
                tokens.fail(count, fmt::format("the number of elements is {}, expected 0 to {}", n, kMaxVertices));
            element.count = std::uint64_t(n);
            header.elements.push_back(std::move(element));
        } else if (key == "property") {
            if (header.elements.empty()) tokens.fail(keyword, "a property before any element");
            Property property;
            Token type = tokens.next_on_line();
            if (lowered(type.text) == "list") {
                const Token counting = tokens.next_on_line();
                property.is_list     = true;
                property.counting    = read_type(tokens, counting);
                if (!is_whole(property.counting)) tokens.fail(counting, "a list counted by fractions");
                type = tokens.next_on_line();
            }
            property.type    = read_type(tokens, type);
            const Token name = tokens.next_on_line();
            if (!name) tokens.fail(name, "a property without a name");
            property.name = lowered(name.text);
            header.elements.back().properties.push_back(std::move(property));
        } else if (header.elements.empty()) {
            if (++left_out == 1) first = fmt::format("line {}: {}", tokens.line(), in_quotes(keyword.text));
            (void)tokens.rest_of_line();  // a backslash at its end joins nothing
        } else {
            tokens.fail(keyword, fmt::format("unknown header line {} (known: format element property comment obj_info "
                                             "end_header)",
                                             in_quotes(keyword.text)));
        }
    }
    if (!has_format) tokens.fail({{}, 0}, "the header names no format, expected \"format ascii 1.0\"");
    if (left_out > 0)
        warnings.push_back(fmt::format("{} of the header {} unknown: the first is {}.",
                                       left_out == 1 ? "a line" : fmt::format("{} lines", left_out),
                                       left_out == 1 ? "is" : "are", first));
    return header;
}

// The numbers behind the header, as text or as bytes.
class Body {
public:
    Body(const SourceText& source, const Header& header)
        : ascii_(header.encoding == Encoding::ascii),
          tokens_(source, header.end),
          bytes_(source, header.end, header.encoding == Encoding::big ? std::endian::big : std::endian::little) {}

    double real(Type type, std::string_view what) {
        if (ascii_) return tokens_.as_number(tokens_.next(), what);
        const std::size_t at = bytes_.offset();
        return bytes_.coordinate(at, number(type, what), what);
    }
    /// NaN and infinity included, for values that may be wrong.
    double any_real(Type type, std::string_view what) {
        return ascii_ ? static_cast<double>(tokens_.any_real(what)) : number(type, what);
    }
    /// Whether text has numbers that no element asked for.
    bool has_more() { return ascii_ && !tokens_.at_end(); }
    std::size_t line() { return tokens_.line(); }
    std::int64_t whole(Type type, std::string_view what) {
        last_ = ascii_ ? tokens_.offset() : bytes_.offset();
        if (!ascii_) return std::int64_t(number(type, what));
        const Token token = tokens_.next();
        last_             = token.offset;
        return tokens_.as_integer(token, what);
    }
    /// Blames the number that whole() read last.
    [[noreturn]] void fail(std::string_view message) const {
        if (ascii_) tokens_.fail({{}, last_}, message);
        bytes_.fail(last_, message);
    }

private:
    double number(Type type, std::string_view what) {
        switch (type) {
            case Type::int8: return bytes_.take<std::int8_t>(what);
            case Type::uint8: return bytes_.take<std::uint8_t>(what);
            case Type::int16: return bytes_.take<std::int16_t>(what);
            case Type::uint16: return bytes_.take<std::uint16_t>(what);
            case Type::int32: return bytes_.take<std::int32_t>(what);
            case Type::uint32: return bytes_.take<std::uint32_t>(what);
            case Type::float32: return double(bytes_.take<float>(what));
            case Type::float64: break;
        }
        return bytes_.take<double>(what);
    }

    bool ascii_;
    Tokens tokens_;
    BinaryReader bytes_;
    std::size_t last_ = 0;
};

// Stanford's strips: -1 begins the next one.
void add_strips(MeshPart& part, const std::vector<std::int64_t>& strip) {
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

// The meaning of an element's properties here: for "vertex" the index of each coordinate in x y z nx ny nz, for faces
// and strips 0 for the list of vertices; kUnused elsewhere.
constexpr int kUnused = -1;
struct Roles {
    std::vector<int> of;  ///< one a property
    bool is_vertex = false, is_face = false, is_strips = false;
    bool has_normals = false;
};

// vertex_indices, vertex_index, and the spellings that programs write: vertex_indexes, vertexIndices, vert_ind.
bool names_vertices(std::string_view property) {
    return property.starts_with("vert") && property.find("ind") != property.npos;
}

Roles find_roles(const Body& body, const Element& element) {
    static constexpr std::array<std::string_view, 6> kCoordinates{"x", "y", "z", "nx", "ny", "nz"};
    Roles roles;
    roles.of.assign(element.properties.size(), kUnused);
    roles.is_vertex = element.name == "vertex";
    roles.is_strips = element.name == "tristrips";
    roles.is_face   = element.name == "face" || roles.is_strips;
    std::array<bool, 6> found{};
    bool has_indices = false;
    for (std::size_t p = 0; p < roles.of.size(); ++p) {
        const Property& property = element.properties[p];
        for (std::size_t k = 0; roles.is_vertex && k < 6; ++k)
            if (!property.is_list && property.name == kCoordinates[k]) roles.of[p] = int(k), found[k] = true;
        if (roles.is_face && property.is_list && is_whole(property.type) && !has_indices &&
            names_vertices(property.name))
            roles.of[p] = 0, has_indices = true;
    }
    if (roles.is_vertex && !(found[0] && found[1] && found[2]))
        body.fail("the element vertex has no properties x, y and z");
    if (roles.is_face && element.count > 0 && !has_indices)
        body.fail(fmt::format("the element {} has no list vertex_indices of whole numbers", element.name));
    roles.has_normals = found[3] && found[4] && found[5];
    return roles;
}

// The vertex indices of one face or of strips, each checked.
void read_indices(Body& body, const Property& property, std::int64_t n, bool is_strips, std::uint64_t vertices,
                  std::vector<std::int64_t>& list) {
    list.clear();
    for (std::int64_t k = 0; k < n; ++k) {
        const std::int64_t v = body.whole(property.type, "the vertex index");
        if ((v < 0 && !(is_strips && v == -1)) || (v >= 0 && std::uint64_t(v) >= vertices))
            body.fail(fmt::format("vertex index {} (there are {}, counted from 0)", v, vertices));
        list.push_back(v);
    }
}

void read_element(Body& body, const Element& element, const Reading& reading, MeshPart& part, std::uint64_t vertices) {
    const Roles roles = find_roles(body, element);
    if (roles.of.empty()) return;  // any number of nothing

    std::vector<std::uint32_t> polygon;
    std::vector<std::int64_t> list;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        std::array<double, 6> c{};  // x y z nx ny nz
        for (std::size_t p = 0; p < roles.of.size(); ++p) {
            const Property& property = element.properties[p];
            const int role           = roles.of[p];
            if (!property.is_list) {
                const bool is_coordinate = roles.is_vertex && role >= 0 && role < 3;
                const double x           = is_coordinate ? body.real(property.type, property.name)
                                                         : body.any_real(property.type, property.name);
                if (roles.is_vertex && role != kUnused) c[std::size_t(role)] = x;
                continue;
            }
            const std::int64_t n = body.whole(property.counting, "the length of a list");
            if (n < 0) body.fail(fmt::format("a list of length {}, expected at least 0", n));
            if (role == kUnused) {
                for (std::int64_t k = 0; k < n; ++k) (void)body.any_real(property.type, property.name);
                continue;
            }
            read_indices(body, property, n, roles.is_strips, vertices, list);
            if (roles.is_strips) {
                add_strips(part, list);
            } else {
                polygon.assign(list.begin(), list.end());
                part.add_polygon(polygon);
            }
        }
        if (roles.is_vertex) {
            part.mesh.positions.push_back(reading.position({c[0], c[1], c[2]}));
            if (roles.has_normals)
                part.mesh.normals.push_back(reading.normal(part.normals.usable(vec3(dvec3(c[3], c[4], c[5])))));
        }
    }
}

MeshPart ply_part(const SourceText& source, const Reading& reading, std::vector<std::string>& warnings) {
    const Header header = read_header(source, warnings);
    const auto named    = [](std::string_view name) { return [name](const Element& e) { return e.name == name; }; };
    const auto vertex   = std::find_if(header.elements.begin(), header.elements.end(), named("vertex"));
    const auto again =
        vertex == header.elements.end() ? vertex : std::find_if(vertex + 1, header.elements.end(), named("vertex"));
    const std::size_t before = header.end;
    if (vertex == header.elements.end() || again != header.elements.end())
        source.fail(0, "the header has not exactly one element vertex");
    // Faces are checked against the vertices, which come first in all files that anyone writes.
    for (auto e = header.elements.begin(); e != vertex; ++e)
        if (e->name == "face" || e->name == "tristrips") source.fail(0, "faces before their vertices");
    for (const Element& e : header.elements) {
        std::uint64_t least = 0;  // bytes of one element
        for (const Property& p : e.properties)
            least += header.encoding == Encoding::ascii ? 2 : size_of(p.is_list ? p.counting : p.type);
        const std::uint64_t left = source.text.size() - before + 1;
        if (least > 0 && e.count > left / least)
            source.fail(0, fmt::format("the header says {} of element {}, but only {} bytes follow it", e.count, e.name,
                                       left - 1));
    }
    if (std::ranges::any_of(vertex->properties, [](const Property& p) { return p.name.ends_with("red"); }))
        warnings.push_back(fmt::format("colours of {} vertices are ignored.", vertex->count));
    MeshPart part;
    Body body(source, header);
    for (const Element& e : header.elements) read_element(body, e, reading, part, vertex->count);
    if (body.has_more())
        warnings.push_back(fmt::format("line {}: what stands behind the last element is ignored.", body.line()));
    return part;
}

}  // namespace

SceneFile read_ply(const std::filesystem::path& file, const Reading& reading) {
    const SourceText source = read_text(file);
    std::vector<std::string> warnings;
    const MeshPart part = ply_part(source, reading, warnings);
    return scene_of({part}, file, warnings);
}

}  // namespace umbra
