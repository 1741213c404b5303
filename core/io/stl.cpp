// STL, text and binary.
//
// 3D Systems. StereoLithography Interface Specification. 1989
#include <array>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/binary_reader.h"
#include "umbra/core/io/mesh_parts.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

// Facets share no positions. Their normals say nothing that their corners do not: they are read and left out, whatever
// their values.
std::vector<MeshPart> read_text_stl(const SourceText& source) {
    Tokens tokens(source);
    std::vector<MeshPart> parts;
    const auto expect = [&](Token token, std::string_view name) {
        if (token.text != name)
            tokens.fail(token, fmt::format("found {}, expected \"{}\"",
                                           token ? in_quotes(token.text) : "the end of the file", name));
    };
    while (!tokens.at_end()) {
        expect(tokens.next(), "solid");
        MeshPart part;
        part.name = tokens.rest_of_line().text;
        for (;;) {
            const Token token = tokens.next();
            if (token.text == "endsolid") {
                (void)tokens.rest_of_line();
                break;
            }
            if (token.text != "facet")
                tokens.fail(token, fmt::format("found {}, expected \"facet\" or \"endsolid\"",
                                               token ? in_quotes(token.text) : "the end of the file"));
            expect(tokens.next(), "normal");
            (void)tokens.normal();
            expect(tokens.next(), "outer");
            expect(tokens.next(), "loop");
            const auto first = std::uint32_t(part.mesh.positions.size());
            for (int k = 0; k < 3; ++k) {
                expect(tokens.next(), "vertex");
                part.mesh.positions.push_back(tokens.point("a vertex coordinate"));
            }
            part.mesh.triangles.emplace_back(first, first + 1, first + 2);
            expect(tokens.next(), "endloop");
            expect(tokens.next(), "endfacet");
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

constexpr std::size_t kStlHeader = 84, kStlFacet = 50;

std::vector<MeshPart> read_binary_stl(const SourceText& source, std::uint32_t facets) {
    BinaryReader bytes(source, kStlHeader, std::endian::little);
    std::vector<MeshPart> parts(1);
    Mesh& mesh = parts[0].mesh;
    for (std::uint32_t i = 0; i < facets; ++i) {
        bytes.skip(12, "a facet");  // the normal
        const auto first = std::uint32_t(mesh.positions.size());
        for (int k = 0; k < 3; ++k) {
            vec3 corner;
            for (int axis = 0; axis < 3; ++axis) {
                const std::size_t at = bytes.offset();
                corner[axis] = bytes.coordinate(at, double(bytes.take<float>("a facet")), "a coordinate of a facet");
            }
            mesh.positions.push_back(corner);
        }
        bytes.skip(2, "a facet");  // the attribute
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return parts;
}

// Binary files may begin with "solid" too, so the length decides: 80 bytes, the number of facets, 50 bytes each.
std::vector<MeshPart> read_parts(const SourceText& source) {
    const std::size_t size = source.text.size();
    std::uint32_t facets   = 0;
    if (size >= kStlHeader) {
        facets = BinaryReader(source, kStlHeader - 4, std::endian::little).take<std::uint32_t>("the header");
        if (size == kStlHeader + std::uint64_t(facets) * kStlFacet) return read_binary_stl(source, facets);
    }
    if (Tokens(source).next().text == "solid") return read_text_stl(source);
    if (size < kStlHeader)
        throw InputError(fmt::format(
            "{}: neither text STL nor binary STL, expected \"solid\" as its first word or at least {} bytes "
            "({} found)",
            source.file, kStlHeader, size));
    throw InputError(fmt::format("{}: byte {}: {} facets take {} bytes, but the file has {}", source.file,
                                 kStlHeader - 4, facets, kStlHeader + std::uint64_t(facets) * kStlFacet, size));
}

}  // namespace

SceneFile read_stl(const std::filesystem::path& file) {
    const SourceText source = read_text(file);
    return scene_of(read_parts(source), file);
}

}  // namespace umbra
