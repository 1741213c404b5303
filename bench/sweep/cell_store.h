// Cells in a folder: one file each, by key. Several processes may read and write at once.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "umbra/bench/run/describe.h"

namespace umbra {

/// Files appear whole or not at all. What is not a cell of its key (cut off, changed by hand) is as if it were not
/// there.
class CellStore {
public:
    /// Makes the folder. What runs that were killed more than a day ago left half-written is removed. Throws
    /// InputError.
    explicit CellStore(std::filesystem::path folder);

    [[nodiscard]] std::optional<Json> find(const std::string& key) const;
    /// `cell["key"]` is its key. Throws InputError.
    void keep(const Json& cell) const;
    /// Takes over what `other` has and this has not. Throws InputError.
    void add_all(const CellStore& other) const;
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
};

}  // namespace umbra
