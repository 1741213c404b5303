// Cells in a folder: one file each, by key. Several processes may read and write at once.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "umbra/bench/base/record.h"
#include "umbra/core/base/error.h"

namespace umbra {

/// Files appear whole or not at all. What is not a cell of its key (cut off, changed by hand) is as if it were not
/// there.
class CellStore {
public:
    /// Makes the folder. What runs that were killed more than a day ago left half-written is removed. Throws
    /// InputError.
    explicit CellStore(std::filesystem::path folder);

    /// What was kept as a `T`, which has a member `key`.
    template <class T>
    [[nodiscard]] std::optional<T> find(const std::string& key) const {
        const Field cell = entry(key);
        if (!cell.present()) return std::nullopt;
        try {
            return from_record<T>(cell);
        } catch (const InputError&) {  // changed by hand
            return std::nullopt;
        }
    }
    [[nodiscard]] bool has(const std::string& key) const { return entry(key).present(); }
    /// Throws InputError.
    template <class T>
    void keep(const T& cell) const {
        write(cell.key, json_text(to_record(cell)));
    }
    /// Takes over what `other` has and this has not. Throws InputError.
    void add_all(const CellStore& other) const;
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    [[nodiscard]] Field entry(const std::string& key) const;  ///< absent where there is none of that key
    void write(const std::string& key, const std::string& text) const;

    std::filesystem::path folder_;
};

}  // namespace umbra
