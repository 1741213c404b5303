// OFF, Geomview's Object File Format, as text, and the forms that other programs write under its name.
//
// Stuart Levy, Tamara Munzner, Mark Phillips. Geomview's Object File Format. 1991
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/limits.h"
#include "umbra/core/io/mesh_parts.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

// The first word ends in OFF; the letters before it say what follows the position of each vertex: normals (N), colours
// (C), texture points (ST), in this order; with 4 a position has a fourth, homogeneous coordinate. The word may be left
// out, and the first count may follow it without a blank.
struct OffHeader {
    bool has_normals = false, has_colours = false, has_texture = false, is_homogeneous = false;
    bool colours_named_last = false;  ///< NC, as in MeshLab, which writes colours before normals
    Token vertices, faces;
};

std::uint64_t read_count(const Tokens& tokens, Token token, std::string_view what) {
    const auto n = tokens.as_integer(token, what);
    if (n < 0 || std::uint64_t(n) > kMaxVertices)
        tokens.fail(token, fmt::format("{} is {}, expected 0 to {}", what, n, kMaxVertices));
    return std::uint64_t(n);
}

bool is_number(Token token) { return token && token.text.find_first_not_of("0123456789") == token.text.npos; }

OffHeader read_off_header(Tokens& tokens, std::vector<std::string>& warnings) {
    OffHeader header;
    const Token magic      = tokens.next();
    const std::string word = lowered(magic.text);
    const std::size_t off  = word.find("off");
    if (is_number(magic)) {
        warnings.emplace_back("the file does not begin with OFF.");
        header.vertices = magic;
    } else {
        const std::string prefix = word.substr(0, off);
        const std::size_t end    = off == word.npos ? 0 : off + 3;
        const Token digits{magic.text.substr(end), magic.offset + end};
        if (off == word.npos || prefix.find_first_not_of("stcn4") != prefix.npos || (digits && !is_number(digits)))
            tokens.fail(magic,
                        fmt::format("the file begins with {}, expected OFF, or OFF with any of S, T, C, N, 4 before it",
                                    in_quotes(magic.text)));
        if (off > 0 && magic.text[off - 1] == 'n' && magic.text[off] == 'O')
            tokens.fail(magic, "OFF of any number of dimensions is not read, expected three");
        const auto names          = [&](char letter) { return prefix.find(letter); };
        header.has_normals        = names('n') != prefix.npos;
        header.has_colours        = names('c') != prefix.npos;
        header.has_texture        = names('t') != prefix.npos;
        header.is_homogeneous     = names('4') != prefix.npos;
        header.colours_named_last = header.has_normals && header.has_colours && names('n') < names('c');
        header.vertices           = digits;
    }
    if (!header.vertices) header.vertices = tokens.next_on_line();
    if (!header.vertices) header.vertices = tokens.next();
    if (lowered(header.vertices.text) == "binary")
        tokens.fail(header.vertices, "binary OFF is not read, expected text");
    header.faces = tokens.next_on_line();
    if (!header.faces) header.faces = tokens.next();
    return header;
}

// The number of edges, which means nothing: on the line of the faces, alone on the next one, or left out.
void skip_edges(Tokens& tokens, std::vector<std::string>& warnings) {
    if (const Token edges = tokens.next_on_line()) {
        (void)tokens.as_integer(edges, "the number of edges");
        return;
    }
    Tokens ahead      = tokens;
    const Token edges = ahead.next();
    if (is_number(edges) && !ahead.next_on_line())
        (void)tokens.next();
    else
        warnings.emplace_back("the number of edges is left out.");
}

// Lines that hold anything.
std::uint64_t lines_from(Tokens ahead) {
    std::uint64_t lines = 0;
    for (; ahead.next(); ahead.skip_line()) ++lines;
    return lines;
}

// The terms that follow the positions of vertices.
class OffVertexTerms {
public:
    explicit OffVertexTerms(const OffHeader& header) : header_(header) {}

    void read(Tokens& tokens, bool on_own_line) {
        std::array<float, 9> terms{};
        std::size_t n = 0;
        for (Token token = on_own_line ? tokens.next() : tokens.next_on_line(); token; token = tokens.next_on_line()) {
            const float term = tokens.as_any_real(token, kNormal);
            if (n < terms.size()) terms.at(n++) = term;
        }
        const std::size_t texture = header_.has_texture ? 2 : 0;
        if (header_.has_normals) {
            if (n < 3) tokens.fail(tokens.next_on_line(), fmt::format("{} is missing, expected a number", kNormal));
            const std::size_t at = header_.has_colours && n >= 4 + texture ? n - texture - 3 : 0;
            first_.emplace_back(terms[0], terms[1], terms[2]);
            last_.emplace_back(terms[at], terms[at + 1], terms[at + 2]);
        }
        if (n > (header_.has_normals ? 3 : 0) + texture) ++coloured_;
    }

    // Either order of normals and colours is in use: where unit vectors are tells which; the header, where both are.
    void take_normals(MeshPart& part, const Reading& reading, std::vector<std::string>& warnings) const {
        const auto units = [](const std::vector<vec3>& vectors) {
            return std::ranges::count_if(vectors, [](vec3 v) { return std::abs(glm::length(v) - 1) < 1e-2f; });
        };
        const auto in_first = units(first_), in_last = units(last_);
        const bool colours_first =
            header_.has_colours && (in_first == in_last ? header_.colours_named_last : in_last > in_first);
        if (colours_first && header_.has_normals)
            warnings.emplace_back("colours of vertices stand before their normals.");
        for (const vec3 normal : colours_first ? last_ : first_)
            part.mesh.normals.push_back(reading.normal(part.normals.usable(normal)));
        if (coloured_ > 0) warnings.push_back(fmt::format("colours of {} vertices are ignored.", coloured_));
    }

private:
    static constexpr std::string_view kNormal = "a normal, colour or texture coordinate";
    const OffHeader& header_;
    std::vector<vec3> first_,
        last_;                  ///< the first three numbers of each vertex, the last three before its texture point
    std::size_t coloured_ = 0;  ///< vertices
};

dvec3 read_position(Tokens& tokens, bool is_homogeneous) {
    constexpr std::string_view kWhat = "a vertex coordinate";
    const dvec3 position             = tokens.point(kWhat);
    if (!is_homogeneous) return position;
    const Token token = tokens.next();
    const double w    = tokens.as_number(token, kWhat);
    const dvec3 p     = position / w;
    if (!(kAnyNumber.holds(p.x) && kAnyNumber.holds(p.y) && kAnyNumber.holds(p.z)))
        tokens.fail(token, fmt::format("the fourth coordinate is {:g}, which puts the vertex out of reach, expected {}",
                                       w, "a number other than 0"));
    return p;
}

void read_vertices(Tokens& tokens, const OffHeader& header, std::uint64_t vertices, std::uint64_t faces,
                   const Reading& reading, MeshPart& part, std::vector<std::string>& warnings) {
    OffVertexTerms terms(header);
    bool own_lines = false;
    for (std::uint64_t i = 0; i < vertices; ++i) {
        if (tokens.at_end())
            tokens.fail(tokens.next(), fmt::format("the file ends after {} of {} vertices", i, vertices));
        part.mesh.positions.push_back(reading.position(read_position(tokens, header.is_homogeneous)));
        if (i == 0 && (header.has_normals || header.has_colours || header.has_texture))
            own_lines = !Tokens(tokens).next_on_line() && lines_from(tokens) >= 2 * vertices - 1 + faces;
        terms.read(tokens, own_lines);
    }
    terms.take_normals(part, reading, warnings);
}

// Whether the next line is a colour of the face before it, and no face.
bool is_colour(Tokens ahead) {
    const Token first = ahead.next();
    std::size_t rest  = 0;
    while (ahead.next_on_line()) ++rest;
    if (!is_number(first)) return true;
    const auto corners = static_cast<std::size_t>(ahead.as_integer(first, "the number of corners"));
    return corners < 3 || corners > rest;
}

void read_faces(Tokens& tokens, std::uint64_t vertices, std::uint64_t faces, MeshPart& part,
                std::vector<std::string>& warnings) {
    std::vector<std::uint32_t> polygon;
    std::size_t coloured = 0;
    bool own_lines       = false;
    for (std::uint64_t i = 0; i < faces; ++i) {
        const Token token = tokens.next();
        if (!token) tokens.fail(token, fmt::format("the file ends after {} of {} faces", i, faces));
        const auto n = tokens.as_integer(token, "the number of corners");
        if (n < 0) tokens.fail(token, fmt::format("a face of {} corners, expected at least 3", n));
        polygon.clear();
        for (std::int64_t k = 0; k < n; ++k) {
            const Token corner = tokens.next();
            if (!corner) tokens.fail(corner, fmt::format("the file ends within a face of {} corners", n));
            const auto v = tokens.as_integer(corner, "the vertex index");
            if (v < 0 || std::uint64_t(v) >= vertices)
                tokens.fail(corner, fmt::format("vertex index {} (there are {}, counted from 0)", v, vertices));
            polygon.push_back(std::uint32_t(v));
        }
        part.add_polygon(polygon);
        bool has_colour = bool(tokens.next_on_line());
        tokens.skip_line();
        if (i == 0 && !has_colour) own_lines = is_colour(tokens) && lines_from(tokens) == 2 * faces - 1;
        if (own_lines) {
            has_colour = bool(tokens.next());
            tokens.skip_line();
        }
        coloured += has_colour;
    }
    if (coloured > 0) warnings.push_back(fmt::format("colours of {} faces are ignored.", coloured));
}

MeshPart off_part(const SourceText& source, const Reading& reading, std::vector<std::string>& warnings) {
    Tokens tokens(source);
    const OffHeader header       = read_off_header(tokens, warnings);
    const std::uint64_t vertices = read_count(tokens, header.vertices, "the number of vertices");
    const std::uint64_t faces    = read_count(tokens, header.faces, "the number of faces");
    skip_edges(tokens, warnings);
    // A vertex takes at least "0 0 0" and a blank, a face "0" and a blank.
    const std::size_t left = source.text.size() - tokens.offset() + 1;
    if (vertices > left / 6)
        tokens.fail(header.vertices, fmt::format("{} vertices, but only {} bytes follow", vertices, left - 1));
    if (faces > left / 2) tokens.fail(header.faces, fmt::format("{} faces, but only {} bytes follow", faces, left - 1));

    MeshPart part;
    read_vertices(tokens, header, vertices, faces, reading, part, warnings);
    read_faces(tokens, vertices, faces, part, warnings);
    return part;
}

}  // namespace

SceneFile read_off(const std::filesystem::path& file, const Reading& reading) {
    const SourceText source = read_text(file);
    std::vector<std::string> warnings;
    const MeshPart part = off_part(source, reading, warnings);
    return scene_of({part}, file, warnings);
}

}  // namespace umbra
