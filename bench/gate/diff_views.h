// The differences of two images, or of two folders of images, as an HTML page and as Markdown for a comment.
#pragma once

#include <filesystem>
#include <string>

#include "umbra/bench/gate/diff_set.h"

namespace umbra {

/// Folder of the page's pictures: FILE with the ending ".files". To be given to diff_set as DiffOptions::pictures.
[[nodiscard]] std::filesystem::path diff_pictures_folder(const std::filesystem::path& file);

/// Writes the page: a table of all images; of those that are comparable and not the same, A, B, the difference map and
/// the figures. The pictures must be in diff_pictures_folder(file). Throws InputError.
void write_diff_page(const std::filesystem::path& file, const DiffSet& set);

/// The longest comment of GitHub, in characters; GitLab's and a job's summary may be longer.
inline constexpr std::size_t kLongestComment = 65536;

/// GitHub's Markdown, at most `longest` bytes: a table of the images that are not the same, the worst verdicts first,
/// then the commands that accept the changes. A row or a command that does not fit is left out and counted.
[[nodiscard]] std::string diff_set_markdown(const DiffSet& set, std::size_t longest = kLongestComment);

}  // namespace umbra
