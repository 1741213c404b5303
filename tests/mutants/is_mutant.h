// The first line of every mutated file in the copy that `./umbra mutants` builds: which change of tests/mutants/*.txt
// acts.
#pragma once

// What is fine in a change that is meant to be wrong.
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wempty-body"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-but-set-parameter"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wunused-variable"

#include <cstdlib>
#include <string_view>

namespace umbra {

/// The identifier in the environment variable UMBRA_MUTANT; empty: no change acts.
inline const std::string_view active_mutant = [] {
    const char* const id = std::getenv("UMBRA_MUTANT");
    return id != nullptr ? std::string_view(id) : std::string_view();
}();

/// Decides at each mutated position whether its change acts. Cheap where none does: the sizes differ.
inline bool is_mutant(std::string_view id) { return id == active_mutant; }

}  // namespace umbra
