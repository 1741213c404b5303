// This work is based on:
// Khronos Group. glTF 2.0 Specification, sections 3.6 (Binary Data Storage) and 4 (GLB). 2021
#include "umbra/core/io/gltf/data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include "umbra/core/base/bytes.h"
#include "umbra/core/io/gltf/members.h"

namespace umbra {
namespace {

using std::filesystem::path;

// Accessors without bytes are all zeros: their length is a mere number in the file. Beyond this many (and as many
// as the file has bytes) they are refused.
constexpr std::uint64_t kFreeZeros = 4096;

std::size_t component_size(int type) { return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4; }

double component(const char* p, int type, bool normalized) {
    switch (type) {
        case 5120:
            return normalized ? std::max(load_number<std::int8_t>(p) / 127.0, -1.0) : load_number<std::int8_t>(p);
        case 5121: return normalized ? load_number<std::uint8_t>(p) / 255.0 : load_number<std::uint8_t>(p);
        case 5122:
            return normalized ? std::max(load_number<std::int16_t>(p) / 32767.0, -1.0) : load_number<std::int16_t>(p);
        case 5123: return normalized ? load_number<std::uint16_t>(p) / 65535.0 : load_number<std::uint16_t>(p);
        case 5125: return load_number<std::uint32_t>(p);
        default: return double(load_number<float>(p));
    }
}

std::uint32_t index_at(const char* p, int type) {
    return type == 5121   ? load_number<std::uint8_t>(p)
           : type == 5123 ? load_number<std::uint16_t>(p)
                          : load_number<std::uint32_t>(p);
}

std::optional<std::string> decode_base64(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() % 4 == 1) return std::nullopt;
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int held           = 0;
    for (const char c : text) {
        int digit = -1;
        if (c >= 'A' && c <= 'Z')
            digit = c - 'A';
        else if (c >= 'a' && c <= 'z')
            digit = c - 'a' + 26;
        else if (c >= '0' && c <= '9')
            digit = c - '0' + 52;
        else if (c == '+' || c == '-')
            digit = 62;
        else if (c == '/' || c == '_')
            digit = 63;
        if (digit < 0) return std::nullopt;
        bits = bits << 6 | std::uint32_t(digit);
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes.push_back(static_cast<char>(bits >> held & 0xff));
        }
    }
    return bytes;
}

// "%20" and the like.
std::string decode_percent(std::string_view uri) {
    const auto hex = [](char c) {
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
    };
    std::string out;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0) {
            out.push_back(static_cast<char>(hex(uri[i + 1]) * 16 + hex(uri[i + 2])));
            i += 2;
        } else {
            out.push_back(uri[i]);
        }
    }
    return out;
}

/// The extension whose compressed data a buffer without bytes stands for; empty where there is none.
std::string_view compression_of(const JsonText& json, const JsonValue& buffer) {
    for (const std::string_view name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (extension(json, buffer, name)) return name;
    return {};
}

/// The first component that is NaN or infinite, as a message; empty where there is none.
std::string find_not_finite(const GltfAccessor& accessor, std::string_view what) {
    if (accessor.component_type != 5126) return {};
    const auto find = [&](std::string_view bytes, std::uint64_t count, std::size_t stride, std::string_view which) {
        for (std::uint64_t i = 0; i < count; ++i)
            for (int c = 0; c < accessor.components; ++c)
                if (const auto x = load_number<float>(bytes.data() + i * stride + std::size_t(c) * 4);
                    !std::isfinite(x))
                    return fmt::format("{}: component {} of {} {} is {}, expected a finite number", what, c, which, i,
                                       x);
        return std::string();
    };
    std::string found;
    if (!accessor.bytes.empty()) found = find(accessor.bytes, accessor.count, accessor.stride, "element");
    if (found.empty())
        found =
            find(accessor.sparse.values, accessor.sparse.count, std::size_t(accessor.components) * 4, "sparse value");
    return found;
}

/// The accessors that some primitive names as its NORMAL. A malformed accessor is refused where it is read.
std::set<std::size_t> find_normal_accessors(const JsonText& json) {
    std::set<std::size_t> normals;
    const auto elements = [](const JsonValue* list) {
        const auto* array = list ? std::get_if<JsonArray>(&list->data) : nullptr;
        return array ? std::span<const JsonValue>(*array) : std::span<const JsonValue>();
    };
    for (const JsonValue& mesh : elements(find_member(json.root(), "meshes")))
        for (const JsonValue& primitive : elements(find_member(mesh, "primitives"))) {
            const JsonValue* attributes = find_member(primitive, "attributes");
            const JsonValue* normal     = attributes ? find_member(*attributes, "NORMAL") : nullptr;
            const double* index         = normal ? std::get_if<double>(&normal->data) : nullptr;
            if (index && *index >= 0 && *index <= kMaxWhole) normals.insert(static_cast<std::size_t>(*index));
        }
    return normals;
}

}  // namespace

GltfData::GltfData(const JsonText& json, const path& file, std::optional<std::string_view> bin)
    : json_(json), folder_(file.parent_path()) {
    read_buffers(bin);
    read_views();
    read_accessors();
}

std::string_view GltfData::file_bytes(const JsonValue& at, const std::string& uri) {
    if (const auto known = owned_.find(uri); known != owned_.end()) return known->second;
    std::string bytes;
    if (uri.starts_with("data:")) {
        // data:[type][;parameter=value...];base64,DIGITS
        const std::size_t comma     = uri.find(',');
        const std::string_view head = std::string_view(uri).substr(5, comma == uri.npos ? 0 : comma - 5);
        if (comma == uri.npos || !head.ends_with(";base64") || head.find(";;") != head.npos)
            json_.fail(at, "the data URI is malformed, expected \"data:application/octet-stream;base64,...\"");
        auto decoded = decode_base64(std::string_view(uri).substr(comma + 1));
        if (!decoded) json_.fail(at, "the data URI holds what is not base64");
        bytes = std::move(*decoded);
    } else {
        std::string name = decode_percent(uri);
        std::error_code error;
        if (!std::filesystem::exists(folder_ / name, error))
            std::replace(name.begin(), name.end(), '\\', '/');  // as viewers in browsers have it
        const path relative(name);
        if (name.empty() || name.find('\0') != name.npos || name.find("://") != name.npos || relative.is_absolute())
            json_.fail(
                at, fmt::format("the URI \"{:.60}\" is not read, expected a file beside this one or a data URI", uri));
        const path target = folder_ / relative;
        if (!std::filesystem::is_regular_file(target, error))
            json_.fail(at, fmt::format("there is no file {}", target.string()));
        bytes = read_text(target).text;
    }
    return owned_.emplace(uri, std::move(bytes)).first->second;
}

std::string_view GltfData::image(const JsonValue& image) {
    if (const JsonValue* index = find_member(image, "bufferView")) return view(*index, "bufferView");
    const JsonValue* uri = find_member(image, "uri");
    if (!uri) json_.fail(image, "this image has no uri and no bufferView");
    return file_bytes(*uri, json_.string(*uri, "uri"));
}

void GltfData::read_buffers(std::optional<std::string_view> bin) {
    const JsonArray& buffers = list_of(json_, json_.root(), "buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        const JsonValue& b = buffers[i];
        const auto what    = fmt::format("buffers[{}]", i);
        (void)json_.object(b, what);
        const JsonValue* length = find_member(b, "byteLength");
        if (!length) json_.fail(b, what + " has no byteLength");
        const auto bytes     = whole(json_, *length, "byteLength", 1, kMaxWhole);
        const JsonValue* uri = find_member(b, "uri");
        std::string_view held;
        if (uri) {
            held = file_bytes(*uri, json_.string(*uri, "uri"));
        } else if (i == 0 && bin) {
            held = *bin;
        } else if (const std::string_view name = compression_of(json_, b); !name.empty()) {
            json_.fail(b, fmt::format("{} has no uri: its data are compressed by {}, expected an export without it",
                                      what, name));
        } else {
            json_.fail(b, what + " has no uri (only the first buffer of a .glb with a binary chunk may lack it)");
        }
        if (held.size() < bytes)
            json_.fail(*length, fmt::format("{} says {} bytes, but {} are there", what, bytes, held.size()));
        buffers_.push_back(held.substr(0, std::size_t(bytes)));
        total_bytes_ += bytes;
    }
}

void GltfData::read_views() {
    const JsonArray& views = list_of(json_, json_.root(), "bufferViews");
    for (std::size_t i = 0; i < views.size(); ++i) {
        const JsonValue& v = views[i];
        const auto what    = fmt::format("bufferViews[{}]", i);
        (void)json_.object(v, what);
        const JsonValue* buffer = find_member(v, "buffer");
        const JsonValue* length = find_member(v, "byteLength");
        const JsonValue* offset = find_member(v, "byteOffset");
        const JsonValue* stride = find_member(v, "byteStride");
        if (!buffer) json_.fail(v, what + " has no buffer");
        if (!length) json_.fail(v, what + " has no byteLength");
        const std::string_view bytes = buffers_[index_into(json_, *buffer, "buffer", buffers_.size())];
        const auto n                 = whole(json_, *length, "byteLength", 1, kMaxWhole);
        const auto begin             = offset ? whole(json_, *offset, "byteOffset", 0, kMaxWhole) : 0;
        if (begin > bytes.size() || n > bytes.size() - begin)
            json_.fail(*length, fmt::format("{} is bytes {} to {} of a buffer of {} bytes", what, begin, begin + n,
                                            bytes.size()));
        views_.push_back(bytes.substr(std::size_t(begin), std::size_t(n)));
        strides_.push_back(stride ? std::size_t(whole(json_, *stride, "byteStride", 4, 252)) : 0);
    }
}

std::string_view GltfData::view(const JsonValue& index, std::string_view what) const {
    return views_[index_into(json_, index, what, views_.size())];
}

void GltfData::read_accessors() {
    static constexpr std::array<std::pair<std::string_view, int>, 7> kTypes{
        {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
    const JsonArray& list               = list_of(json_, json_.root(), "accessors");
    const std::set<std::size_t> normals = find_normal_accessors(json_);
    std::vector<std::string_view> type_names;
    for (const auto& [name, components] : kTypes) type_names.push_back(name);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const JsonValue& a = list[i];
        const auto what    = fmt::format("accessors[{}]", i);
        (void)json_.object(a, what);
        const auto need = [&](const JsonValue& object, std::string_view key) -> const JsonValue& {
            const JsonValue* v = find_member(object, key);
            if (!v) json_.fail(object, fmt::format("{} has no {}", what, key));
            return *v;
        };
        const auto component_type = [&](const JsonValue& v, bool index) {
            const auto type = int(whole(json_, v, "componentType", 5120, 5126));
            if (type == 5124 || (index && type != 5121 && type != 5123 && type != 5125))
                json_.fail(v, fmt::format("componentType is {}, expected {}", type,
                                          index ? "5121, 5123 or 5125" : "5120, 5121, 5122, 5123, 5125 or 5126"));
            return type;
        };

        GltfAccessor accessor;
        accessor.json           = &a;
        const JsonValue& count  = need(a, "count");
        accessor.count          = whole(json_, count, "count", 1, kMaxWhole);
        accessor.component_type = component_type(need(a, "componentType"), false);
        const JsonValue& type   = need(a, "type");
        accessor.components     = kTypes[json_.choice(type, "type", type_names)].second;
        if (const JsonValue* n = find_member(a, "normalized")) accessor.normalized = json_.boolean(*n, "normalized");

        const std::size_t size = component_size(accessor.component_type) * std::size_t(accessor.components);
        if (const JsonValue* index = find_member(a, "bufferView")) {
            const std::size_t v          = index_into(json_, *index, "bufferView", views_.size());
            const JsonValue* offset      = find_member(a, "byteOffset");
            const std::uint64_t begin    = offset ? whole(json_, *offset, "byteOffset", 0, kMaxWhole) : 0;
            const std::string_view bytes = views_[v];
            accessor.stride              = strides_[v] > 0 ? strides_[v] : size;
            if (accessor.stride < size)
                json_.fail(*index, fmt::format("{} has elements of {} bytes, but its bufferView a byteStride of {}",
                                               what, size, accessor.stride));
            // In this order nothing overflows: (count - 1) * stride + size <= left.
            const std::uint64_t left = begin <= bytes.size() ? bytes.size() - begin : 0;
            if (left < size || accessor.count - 1 > (left - size) / accessor.stride)
                json_.fail(count,
                           fmt::format("{} has {} elements {} bytes apart from byte {} on, but its bufferView has "
                                       "{} bytes",
                                       what, accessor.count, accessor.stride, begin, bytes.size()));
            accessor.bytes = bytes.substr(std::size_t(begin));
        } else if (accessor.count > kFreeZeros + total_bytes_) {
            json_.fail(count, fmt::format("{} has {} elements and no bufferView, in a file with {} bytes of data", what,
                                          accessor.count, total_bytes_));
        }

        if (const JsonValue* sparse = find_member(a, "sparse")) {
            (void)json_.object(*sparse, "sparse");
            GltfAccessor::Sparse& s  = accessor.sparse;
            const JsonValue& n       = need(*sparse, "count");
            const JsonValue& indices = need(*sparse, "indices");
            const JsonValue& values  = need(*sparse, "values");
            s.count                  = whole(json_, n, "count", 1, double(accessor.count));
            s.index_type             = component_type(need(indices, "componentType"), true);
            const auto part          = [&](const JsonValue& where, std::size_t element) {
                const std::string_view bytes = view(need(where, "bufferView"), "bufferView");
                const JsonValue* offset      = find_member(where, "byteOffset");
                const auto begin             = offset ? whole(json_, *offset, "byteOffset", 0, kMaxWhole) : 0;
                if (begin > bytes.size() || s.count > (bytes.size() - begin) / element)
                    json_.fail(where, fmt::format("{} sparse elements of {} bytes from byte {} on, but the bufferView "
                                                                    "has {} bytes",
                                                           s.count, element, begin, bytes.size()));
                return bytes.substr(std::size_t(begin));
            };
            s.indices              = part(indices, component_size(s.index_type));
            s.values               = part(values, size);
            std::uint64_t previous = 0;
            for (std::uint64_t k = 0; k < s.count; ++k) {
                const std::uint64_t at = index_at(s.indices.data() + k * component_size(s.index_type), s.index_type);
                if (at >= accessor.count || (k > 0 && at <= previous))
                    json_.fail(indices, fmt::format("sparse index {} of element {}, expected rising ones below {}", at,
                                                    k, accessor.count));
                previous = at;
            }
        }
        accessor.not_finite = find_not_finite(accessor, what);
        if (!accessor.not_finite.empty() && !normals.contains(i)) json_.fail(a, accessor.not_finite);
        accessors_.push_back(std::move(accessor));
    }
}

namespace {

template <class Vector>
std::vector<Vector> read_vectors(const GltfAccessor& accessor) {
    std::vector<Vector> out(std::size_t(accessor.count), Vector(0));
    const std::size_t size = component_size(accessor.component_type);
    const auto read        = [&](const char* p) {
        Vector v(0);
        for (int c = 0; c < std::min<int>(accessor.components, sizeof(Vector) / sizeof(float)); ++c)
            glm::value_ptr(v)[c] =
                static_cast<float>(component(p + std::size_t(c) * size, accessor.component_type, accessor.normalized));
        return v;
    };
    if (!accessor.bytes.empty())
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = read(accessor.bytes.data() + i * accessor.stride);
    const auto& s = accessor.sparse;
    for (std::size_t k = 0; k < s.count; ++k)
        out[index_at(s.indices.data() + k * component_size(s.index_type), s.index_type)] =
            read(s.values.data() + k * size * std::size_t(accessor.components));
    return out;
}

}  // namespace

std::vector<vec3> GltfData::vectors(const GltfAccessor& accessor) const { return read_vectors<vec3>(accessor); }
std::vector<vec4> GltfData::quadruples(const GltfAccessor& accessor) const { return read_vectors<vec4>(accessor); }

std::vector<mat4> GltfData::matrices(const GltfAccessor& accessor) const { return read_vectors<mat4>(accessor); }

std::vector<std::uint32_t> GltfData::indices(const GltfAccessor& accessor) const {
    std::vector<std::uint32_t> out(std::size_t(accessor.count), 0);
    if (!accessor.bytes.empty())
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = index_at(accessor.bytes.data() + i * accessor.stride, accessor.component_type);
    const auto& s = accessor.sparse;
    for (std::size_t k = 0; k < s.count; ++k)
        out[index_at(s.indices.data() + k * component_size(s.index_type), s.index_type)] =
            index_at(s.values.data() + k * component_size(accessor.component_type), accessor.component_type);
    return out;
}

}  // namespace umbra
