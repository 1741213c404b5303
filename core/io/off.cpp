// OFF, Geomview's Object File Format, as text.
//
// Stuart Levy, Tamara Munzner, Mark Phillips. Geomview's Object File Format. 1991
#include <fmt/format.h>

#include "umbra/core/io/limits.h"
#include "umbra/core/io/mesh_parts.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

// The first token ends in OFF; the letters before it say what follows each vertex: S, T texture points, C colours,
// N normals.
MeshPart off_part(const SourceText& source) {
    Tokens tokens(source);
    const Token header    = tokens.next();
    const std::size_t end = header.text.size();
    if (!header.text.ends_with("OFF") || header.text.substr(0, end - 3).find_first_not_of("STCN") != header.text.npos)
        tokens.fail(header,
                    fmt::format("the file begins with {}, expected OFF, or OFF with any of S, T, C, N before it",
                                in_quotes(header.text)));
    const bool has_normals = header.text.find('N') != header.text.npos;

    Token first = tokens.next_on_line();
    if (!first) first = tokens.next();
    if (first.text == "BINARY") tokens.fail(first, "binary OFF is not read, expected text");
    const auto count = [&](Token token, std::string_view what) {
        const auto n = tokens.as_integer(token, what);
        if (n < 0 || std::uint64_t(n) > kMaxVertices)
            tokens.fail(token, fmt::format("{} is {}, expected 0 to {}", what, n, kMaxVertices));
        return std::uint64_t(n);
    };
    const std::uint64_t vertices = count(first, "the number of vertices");
    const Token faces_token      = tokens.next_on_line();
    const std::uint64_t faces    = count(faces_token, "the number of faces");
    (void)count(tokens.next_on_line(), "the number of edges");
    // A vertex takes at least "0 0 0" and a blank, a face "0" and a blank.
    const std::size_t left = source.text.size() - tokens.offset() + 1;
    if (vertices > left / 6)
        tokens.fail(first, fmt::format("{} vertices, but only {} bytes follow", vertices, left - 1));
    if (faces > left / 2) tokens.fail(faces_token, fmt::format("{} faces, but only {} bytes follow", faces, left - 1));

    MeshPart part;
    for (std::uint64_t i = 0; i < vertices; ++i) {
        if (tokens.at_end())
            tokens.fail(tokens.next(), fmt::format("the file ends after {} of {} vertices", i, vertices));
        part.mesh.positions.push_back(tokens.point("a vertex coordinate"));
        if (has_normals) part.mesh.normals.push_back(part.normals.usable(tokens.normal()));
        while (const Token extra = tokens.next_on_line()) (void)tokens.as_real(extra, "a colour or texture coordinate");
    }
    std::vector<std::uint32_t> polygon;
    for (std::uint64_t i = 0; i < faces; ++i) {
        const Token token = tokens.next();
        if (!token) tokens.fail(token, fmt::format("the file ends after {} of {} faces", i, faces));
        const auto n = tokens.as_integer(token, "the number of corners");
        if (n < 3) tokens.fail(token, fmt::format("a face of {} corners, expected at least 3", n));
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
        tokens.skip_line();  // a colour may follow
    }
    return part;
}

}  // namespace

SceneFile read_off(const std::filesystem::path& file) {
    const SourceText source = read_text(file);
    return scene_of({off_part(source)}, file);
}

}  // namespace umbra
