// The truth of a view in a file, so that processes that share a sweep find it once.
#pragma once

#include <filesystem>

#include "umbra/bench/lab/reference.h"

namespace umbra {

/// The planes of a reference, bit by bit, as an EXR: for light j the channels "s.j" and "half_width.j", and in whole
/// numbers "answer.j" and "judged.j". Appears whole or not at all. Throws InputError.
void write_truth(const std::filesystem::path& file, const ReferenceRun& ran, int width, int height);

/// Fills planes, judged points and counts of `ran`; false where there is no such file, or it does not fit.
[[nodiscard]] bool read_truth(const std::filesystem::path& file, std::size_t lights, std::size_t points,
                              ReferenceRun& ran);

}  // namespace umbra
