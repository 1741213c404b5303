// What libFuzzer calls, for the targets of one program: UMBRA_FUZZ_TARGETS, which CMake defines. UMBRA_FUZZ_TARGET
// names one of them; `./umbra fuzz` sets it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "umbra/core/base/parallel.h"
#include "umbra/tests/fuzz/json_mutator.h"
#include "umbra/tests/fuzz/targets.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

const umbra::FuzzTarget& target() {
    static const umbra::FuzzTarget& chosen = [&]() -> const umbra::FuzzTarget& {
        const char* name = std::getenv("UMBRA_FUZZ_TARGET");
        std::string known;
        for (const umbra::FuzzTarget& t : umbra::UMBRA_FUZZ_TARGETS()) {
            if (name != nullptr && t.name == name) return t;
            known += " " + std::string(t.name);
        }
        std::fprintf(stderr, "UMBRA_FUZZ_TARGET: expected one of%s\n", known.c_str());
        std::exit(64);
    }();
    return chosen;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const umbra::ThreadLimit one(1);  // the same coverage every time
    target().run({data, size});
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    if (target().json && seed % 8 != 0) {
        std::mt19937 random(seed);
        const auto changed = umbra::mutated_json({reinterpret_cast<const char*>(data), size}, random);
        if (changed && changed->size() <= max_size) {
            std::copy(changed->begin(), changed->end(), data);
            return changed->size();
        }
    }
    return LLVMFuzzerMutate(data, size, max_size);
}
