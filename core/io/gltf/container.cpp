// This work is based on:
// Khronos Group. glTF 2.0 Specification, section 4 (GLB). 2021
#include "umbra/core/io/gltf/container.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "umbra/core/base/bytes.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/gltf/members.h"

namespace umbra {

// A .glb is a header of 12 bytes and chunks: JSON first, then perhaps BIN.
GltfFile open_gltf(const std::filesystem::path& file) {
    GltfFile document;
    SourceText source = read_text(file);
    if (source.text.empty()) throw InputError(fmt::format("{}: empty, expected a glTF 2.0 file", source.file));
    std::string ending = file.extension().string();
    const bool binary  = source.text.starts_with("glTF");
    if (!binary && (ending == ".glb" || ending == ".GLB"))
        throw InputError(
            fmt::format("{}: byte 0: does not begin with the letters glTF, as every .glb does", source.file));
    if (!binary) {
        constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
        if (source.text.starts_with(kByteOrderMark)) source.text.erase(0, kByteOrderMark.size());
        document.json = std::move(source);
        return document;
    }

    document.whole  = std::move(source.text);
    const auto fail = [&](std::size_t byte, const std::string& message) {
        throw InputError(fmt::format("{}: byte {}: {}", source.file, byte, message));
    };
    const std::string_view all = document.whole;
    const auto word            = [&](std::size_t at) { return load_number<std::uint32_t>(all.data() + at); };
    if (all.size() < 20) fail(0, fmt::format("{} bytes (a .glb has at least 20)", all.size()));
    if (word(4) != 2) fail(4, fmt::format("version {} of the container, expected 2", word(4)));
    const std::size_t says = word(8);
    if (says > all.size()) fail(8, fmt::format("the header says {} bytes, but the file has {}", says, all.size()));
    if (says < all.size())
        document.warnings.push_back(
            fmt::format("The header says {} bytes, but the file has {}: what lies behind its chunks is ignored.", says,
                        all.size()));
    std::optional<std::string_view> json;
    constexpr std::uint32_t kJson = 0x4e4f534a, kBin = 0x004e4942;
    std::size_t at = 12;
    for (int chunk = 0; at < all.size(); ++chunk) {
        const std::size_t left = all.size() - at;
        const bool may_be_bin  = chunk == 1 && left >= 8 && word(at + 4) == kBin && word(at) <= left - 8;
        if (chunk > 0 && at >= says && !may_be_bin) break;
        if (left < 8) fail(at, "the file ends within the head of a chunk");
        const std::uint32_t length = word(at), type = word(at + 4);
        if (length > left - 8) fail(at, fmt::format("a chunk of {} bytes, but {} are left", length, left - 8));
        const std::string_view body = all.substr(at + 8, length);
        if (chunk == 0 && type != kJson) fail(at + 4, "the first chunk is not JSON");
        if (chunk == 0) json = body;
        if (chunk == 1 && type == kBin) document.bin = body;
        at += 8 + length;
    }
    document.json = SourceText{source.file + " (JSON chunk)", std::string(json.value_or(""))};
    return document;
}

void check_version(const JsonText& json) {
    (void)json.object(json.root(), "the document");
    const JsonValue* asset = find_member(json.root(), "asset");
    if (!asset) json.fail(json.root(), "no \"asset\", so this is not glTF, expected \"asset\": {\"version\": \"2.0\"}");
    (void)json.object(*asset, "asset");
    const JsonValue* version = find_member(*asset, "version");
    if (!version) json.fail(*asset, "asset has no version, expected \"2.0\"");
    if (!json.string(*version, "version").starts_with("2."))
        json.fail(*version, fmt::format("version \"{:.20}\", expected \"2.0\"", json.string(*version, "version")));
}

// Extensions that are needed to understand the geometry must be known; those that only change the appearance may be
// ignored.
void check_extensions(const JsonText& json, std::vector<std::string>& warnings) {
    static constexpr std::array<std::string_view, 10> kRead{
        "KHR_lights_punctual",        "EXT_lights_area",     "EXT_mesh_gpu_instancing",
        "KHR_mesh_quantization",      "KHR_materials_unlit", "KHR_materials_emissive_strength",
        "KHR_materials_transmission", "KHR_materials_ior",   "KHR_materials_pbrSpecularGlossiness",
        "KHR_node_visibility"};
    static constexpr std::array<std::string_view, 5> kAppearance{"KHR_texture_", "EXT_texture_", "MSFT_texture_",
                                                                 "KHR_materials_", "KHR_animation_"};
    const auto is_read = [](std::string_view name) {
        return std::find(kRead.begin(), kRead.end(), name) != kRead.end();
    };
    const auto is_appearance = [](std::string_view name) {
        return std::any_of(kAppearance.begin(), kAppearance.end(),
                           [&](std::string_view prefix) { return name.starts_with(prefix); });
    };
    for (const JsonValue& v : list_of(json, json.root(), "extensionsRequired")) {
        const std::string& name = json.string(v, "the name of an extension");
        if (!is_read(name) && !is_appearance(name))
            json.fail(
                v, fmt::format("the file requires the extension {:.60}, which is not read, expected an export without "
                               "it",
                               name));
    }
    std::vector<std::string> ignored;
    for (const JsonValue& v : list_of(json, json.root(), "extensionsUsed"))
        if (const std::string& name = json.string(v, "the name of an extension"); !is_read(name))
            ignored.push_back(name);
    if (ignored.size() > 10) ignored.resize(10);
    if (!ignored.empty())
        warnings.push_back(fmt::format("Extensions that are not read are ignored: {}.", fmt::join(ignored, ", ")));
}

}  // namespace umbra
