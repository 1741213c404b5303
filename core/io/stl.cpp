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

// A word of the grammar, in any case; "end loop" is "endloop".
Token next_word(Tokens& tokens, std::string& word) {
    const Token token = tokens.next();
    word              = lowered(token.text);
    if (word == "end") word += lowered(tokens.next().text);
    return token;
}

// Facets share no positions. Their normals say nothing that their corners do not: they are read and left out, whatever
// their values.
std::vector<MeshPart> read_text_stl(const SourceText& source, const Reading& reading,
                                    std::vector<std::string>& warnings) {
    Tokens tokens(source);
    std::vector<MeshPart> parts;
    std::string word;
    const auto refuse = [&](Token found, std::string_view expected) {
        tokens.fail(found, fmt::format("found {}, expected {}", found ? in_quotes(found.text) : "the end of the file",
                                       expected));
    };
    const auto expect = [&](std::string_view name) {
        if (const Token token = next_word(tokens, word); word != name) refuse(token, fmt::format("\"{}\"", name));
    };
    std::size_t unended = 0;
    bool begun          = false;  // the word "solid" is read
    while (begun || !tokens.at_end()) {
        if (!begun) expect("solid");
        begun = false;
        MeshPart part;
        part.name = tokens.rest_of_line().text;
        for (;;) {
            const Token token = next_word(tokens, word);
            if (word == "endsolid") {
                (void)tokens.rest_of_line();
                break;
            }
            if (begun = word == "solid"; begun || !token) {
                ++unended;
                break;
            }
            if (word != "facet") refuse(token, "\"facet\" or \"endsolid\"");
            expect("normal");
            (void)tokens.normal();
            expect("outer");
            expect("loop");
            const auto first = std::uint32_t(part.mesh.positions.size());
            for (int k = 0; k < 3; ++k) {
                expect("vertex");
                part.mesh.positions.push_back(reading.position(tokens.point("a vertex coordinate")));
            }
            part.mesh.triangles.emplace_back(first, first + 1, first + 2);
            expect("endloop");
            expect("endfacet");
        }
        parts.push_back(std::move(part));
    }
    if (unended > 0) warnings.push_back(fmt::format("{} solids have no endsolid.", unended));
    return parts;
}

constexpr std::size_t kStlHeader = 84, kStlFacet = 50;

std::vector<MeshPart> read_binary_stl(const SourceText& source, const Reading& reading, std::uint64_t facets) {
    BinaryReader bytes(source, kStlHeader, std::endian::little);
    std::vector<MeshPart> parts(1);
    Mesh& mesh = parts[0].mesh;
    for (std::uint64_t i = 0; i < facets; ++i) {
        bytes.skip(12, "a facet");  // the normal
        const auto first = std::uint32_t(mesh.positions.size());
        for (int k = 0; k < 3; ++k) {
            dvec3 corner;
            for (int axis = 0; axis < 3; ++axis) {
                const std::size_t at = bytes.offset();
                corner[axis] = bytes.coordinate(at, double(bytes.take<float>("a facet")), "a coordinate of a facet");
            }
            mesh.positions.push_back(reading.position(corner));
        }
        bytes.skip(2, "a facet");  // the attribute
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return parts;
}

// Binary files may begin with "solid", too, but have zeros soon, which text has not.
bool is_text(const SourceText& source) {
    constexpr std::size_t kLooked = 1024;
    const auto looked             = std::string_view(source.text).substr(0, kLooked);
    return lowered(Tokens(source).next().text) == "solid" && looked.find('\0') == looked.npos;
}

// Binary: 80 bytes, the number of facets, 50 bytes each. Programs that write facets as they find them leave the number
// at 0 or -1: then the size of the file says it.
std::vector<MeshPart> read_parts(const SourceText& source, const Reading& reading, std::vector<std::string>& warnings) {
    const std::size_t size = source.text.size();
    if (size < kStlHeader) {
        if (is_text(source)) return read_text_stl(source, reading, warnings);
        throw InputError(fmt::format(
            "{}: neither text STL nor binary STL, expected \"solid\" as its first word or at least {} bytes "
            "({} found)",
            source.file, kStlHeader, size));
    }
    const auto says = BinaryReader(source, kStlHeader - 4, std::endian::little).take<std::uint32_t>("the header");
    const std::uint64_t room = (size - kStlHeader) / kStlFacet, rest = (size - kStlHeader) % kStlFacet;
    if (says == room && rest == 0) return read_binary_stl(source, reading, says);
    if (is_text(source)) return read_text_stl(source, reading, warnings);
    if ((says == 0 || says == ~std::uint32_t{0}) && rest == 0) {
        warnings.push_back(
            fmt::format("the header says {} facets, the file has {}: all are read.", std::int32_t(says), room));
        return read_binary_stl(source, reading, room);
    }
    if (says > room || says == 0)
        throw InputError(fmt::format("{}: byte {}: {} facets take {} bytes, but the file has {}", source.file,
                                     kStlHeader - 4, says, kStlHeader + std::uint64_t(says) * kStlFacet, size));
    warnings.push_back(fmt::format("{} bytes behind the {} facets that the header says are ignored.",
                                   size - kStlHeader - says * kStlFacet, says));
    return read_binary_stl(source, reading, says);
}

}  // namespace

SceneFile read_stl(const std::filesystem::path& file, const Reading& reading) {
    const SourceText source = read_text(file);
    std::vector<std::string> warnings;
    const std::vector<MeshPart> parts = read_parts(source, reading, warnings);
    return scene_of(parts, file, warnings);
}

}  // namespace umbra
