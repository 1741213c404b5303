// Disjoint sets of the numbers 0 .. n - 1. [Robert Tarjan, Jan van Leeuwen, Worst-Case Analysis of Set Union
// Algorithms, 1984: path halving] Unlike boost::disjoint_sets it keeps one array, and a set's root is its smallest
// number, so that roots do not depend on the order of calls.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace umbra {

class DisjointSets {
public:
    explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

    /// The smallest number of the set that holds i.
    [[nodiscard]] std::uint32_t root(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void unite(std::uint32_t i, std::uint32_t j) {
        i                       = root(i);
        j                       = root(j);
        parent_[std::max(i, j)] = std::min(i, j);
    }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace umbra
