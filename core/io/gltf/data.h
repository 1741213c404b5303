// The numbers of a glTF file: its buffers, buffer views and accessors, all checked before anyone uses them.
// Internal to core.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/base/math.h"
#include "umbra/core/io/json_text.h"

namespace umbra {

/// An element count, a type, and where the bytes are. An accessor without a view is all zeros.
struct GltfAccessor {
    const JsonValue* json = nullptr;
    std::uint64_t count   = 0;
    int component_type    = 5126;  ///< 5120 int8, 5121 uint8, 5122 int16, 5123 uint16, 5125 uint32, 5126 float
    int components        = 1;     ///< SCALAR 1, VEC3 3, MAT4 16 ...
    bool normalized       = false;
    std::string_view bytes;  ///< from the first element on; empty: zeros
    std::size_t stride = 0;
    struct Sparse {
        std::uint64_t count = 0;
        int index_type      = 5123;
        std::string_view indices;
        std::string_view values;
    } sparse;
    std::string not_finite;  ///< where a component is NaN or infinite: the message that says so
};

class GltfData {
public:
    /// Reads and checks "buffers", "bufferViews" and "accessors" of the document, used or not: ranges, types, and that
    /// no float is NaN or infinite, but in accessors that a primitive names as its NORMAL. `bin` is the binary chunk of
    /// a .glb. Throws InputError.
    GltfData(const JsonText& json, const std::filesystem::path& file, std::optional<std::string_view> bin);

    [[nodiscard]] const std::vector<GltfAccessor>& accessors() const { return accessors_; }
    /// Any vector type; normalised integers as the fractions that they represent.
    [[nodiscard]] std::vector<vec3> vectors(const GltfAccessor& accessor) const;
    [[nodiscard]] std::vector<vec4> quadruples(const GltfAccessor& accessor) const;  ///< the same of four numbers
    [[nodiscard]] std::vector<mat4> matrices(const GltfAccessor& accessor) const;    ///< of sixteen, column by column
    [[nodiscard]] std::vector<std::uint32_t> indices(const GltfAccessor& accessor) const;

    /// The file of images[], wherever it is: kept as long as this object. Throws InputError.
    [[nodiscard]] std::string_view image(const JsonValue& image);

private:
    [[nodiscard]] std::string_view file_bytes(const JsonValue& at, const std::string& uri);
    [[nodiscard]] std::string_view view(const JsonValue& index, std::string_view what) const;
    void read_buffers(std::optional<std::string_view> bin);
    void read_views();
    void read_accessors();

    const JsonText& json_;
    std::filesystem::path folder_;
    std::map<std::string, std::string> owned_;  // by URI: many buffers may share one file
    std::vector<std::string_view> buffers_;
    std::vector<std::string_view> views_;
    std::vector<std::size_t> strides_;  // of views_; 0: tightly packed
    std::vector<GltfAccessor> accessors_;
    std::uint64_t total_bytes_ = 0;
};

}  // namespace umbra
