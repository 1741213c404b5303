// What is fuzzed: functions that take any bytes as a file, and must read or refuse them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace umbra {

using Bytes = std::span<const std::uint8_t>;

struct FuzzTarget {
    std::string_view name;  ///< also the folder of its seeds, below tests/fuzz/corpus
    /// Returns where the bytes were read, or refused with an InputError or a UsageError. Anything else that it throws,
    /// as std::logic_error of a method that breaks its contract, is a fault.
    void (*run)(Bytes bytes);
    bool json = false;  ///< its files are JSON, which mutated_json() changes as such
};

/// The readers of scene files. They need umbra_core alone, so that their fuzzer is small and fast.
[[nodiscard]] std::span<const FuzzTarget> reader_targets();

/// The readers of images and of results.json, and the whole pipeline behind a scene.
[[nodiscard]] std::span<const FuzzTarget> program_targets();

}  // namespace umbra
