// The differences of two images, or of two folders of images, as an HTML page.
#pragma once

#include <filesystem>

#include "umbra/bench/diff/diff_set.h"

namespace umbra {

/// Folder of the page's pictures: FILE with the ending ".files". To be given to diff_set as DiffOptions::pictures.
[[nodiscard]] std::filesystem::path diff_pictures_folder(const std::filesystem::path& file);

/// Writes the page: a table of all images; of those that are comparable and not the same, A, B, the difference map and
/// the figures. The pictures must be in diff_pictures_folder(file). Throws InputError.
void write_diff_page(const std::filesystem::path& file, const DiffSet& set);

}  // namespace umbra
