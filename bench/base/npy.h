// Arrays as NumPy's .npy files, version 1.0: what every language reads in a few lines. Own code, as the libraries for it
// are either no longer kept or bring an array type of their own with them.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace umbra {

using Shape = std::vector<std::size_t>;

/// Writes `bytes`, row by row, as an array of `shape` whose items are `type`: a NumPy type ("<f4"), or the list of the
/// fields of a record ("[('u', '<f4'), ('v', '<f4')]"). Throws InputError where the file cannot be written.
void write_npy(const std::filesystem::path& file, std::string_view type, const Shape& shape,
               std::span<const std::byte> bytes);

/// The same of floats or unsigned integers.
template <class T>
void write_npy(const std::filesystem::path& file, const std::vector<T>& items, const Shape& shape) {
    static_assert(std::is_floating_point_v<T> || std::is_unsigned_v<T>);
    const char order = sizeof(T) == 1 ? '|' : '<', kind = std::is_floating_point_v<T> ? 'f' : 'u';
    write_npy(file, fmt::format("{}{}{}", order, kind, sizeof(T)), shape, std::as_bytes(std::span(items)));
}

struct Numbers {
    Shape shape;
    std::vector<float> values;  ///< row by row; one item of shape {} is one value
};

/// Reads numbers of any simple type (floats of 2, 4 and 8 bytes, integers, booleans, either order of bytes, rows or
/// columns first). Throws InputError: the file, what was found, what is expected. Sizes are checked before memory is
/// taken.
[[nodiscard]] Numbers read_npy(const std::filesystem::path& file);

/// "360 x 640"; "one number" of a shape without sides.
[[nodiscard]] std::string in_words(const Shape& shape);

}  // namespace umbra
