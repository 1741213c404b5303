// A glTF file, as text or as a .glb, and whether it can be read at all. Internal to core.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "umbra/core/io/json_text.h"

namespace umbra {

struct GltfFile {
    SourceText json;    ///< the document
    std::string whole;  ///< the .glb, which `bin` points into
    std::optional<std::string_view> bin;
    std::vector<std::string> warnings;
};

/// Throws InputError where a .glb is shorter than its header or chunks say. Bytes behind them are ignored, and a length
/// in its header that ends before its chunks do, with a warning.
[[nodiscard]] GltfFile open_gltf(const std::filesystem::path& file);

/// Refuses documents of other versions than 2.x.
void check_version(const JsonText& json);

/// Refuses extensions that are required, not read, and may change the geometry. Adds a warning for those that are
/// ignored.
void check_extensions(const JsonText& json, std::vector<std::string>& warnings);

}  // namespace umbra
