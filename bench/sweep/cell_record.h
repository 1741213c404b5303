// A cell as a record: what one setting gets wrong in one view of a scene.
#pragma once

#include <optional>
#include <string>

#include "umbra/bench/lab/results.h"

namespace umbra {

struct Cell {
    MethodRecord method{};              ///< without times and files
    std::optional<double> undefined{};  ///< the fraction of the points that it does not answer
    std::uint64_t view = 0;
    std::string key{};   ///< of what the cell depends on
    bool brief = false;  ///< as of CellOptions: no memory, and what it says of classes and edges is not their value
};
DESCRIBE(Cell) {
    of.all(&R::method);
    of.may(MEMBER(undefined));
    MEMBERS(view, key, brief);
}

}  // namespace umbra
