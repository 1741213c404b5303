// A binary file read from front to back, each step checked against its end. Internal to core.
#pragma once

#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/bytes.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/source_text.h"

namespace umbra {

/// Every fault is an InputError "FILE: byte N: message".
class BinaryReader {
public:
    /// `source` must outlive this object; reading begins at byte `begin`.
    BinaryReader(const SourceText& source, std::size_t begin, std::endian order)
        : source_(source), at_(begin), order_(order) {}

    [[nodiscard]] std::size_t offset() const { return at_; }
    [[noreturn]] void fail(std::size_t offset, std::string_view message) const {
        throw InputError(fmt::format("{}: byte {}: {}", source_.file, offset, message));
    }
    void skip(std::uint64_t n, std::string_view what) {
        require(n, what);
        at_ += static_cast<std::size_t>(n);
    }
    template <class T>
    T take(std::string_view what) {
        require(sizeof(T), what);
        const T x = load_number<T>(source_.text.data() + at_, order_);
        at_ += sizeof(T);
        return x;
    }
    /// `x`, which was read at `offset`, as a coordinate: finite and within kMaxCoordinate.
    [[nodiscard]] double coordinate(std::size_t offset, double x, std::string_view what) const {
        if (!kAnyNumber.holds(x)) fail(offset, fmt::format("{} is {:g}, expected {}", what, x, kAnyNumber.words));
        return x;
    }

private:
    void require(std::uint64_t n, std::string_view what) const {
        if (source_.text.size() - at_ < n) fail(at_, fmt::format("the file ends within {}", what));
    }

    const SourceText& source_;
    std::size_t at_;
    std::endian order_;
};

}  // namespace umbra
