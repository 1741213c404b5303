// The differences of two images, or of two folders of images, as Markdown for a comment or a job's summary.
#pragma once

#include <string>

#include "umbra/bench/diff/diff_set.h"

namespace umbra {

/// The longest comment of GitHub, in characters; GitLab's and a job's summary may be longer.
inline constexpr std::size_t kLongestComment = 65536;

/// GitHub's Markdown, at most `longest` bytes: a table of the images that are not the same, the worst verdicts first,
/// then the commands that accept the changes. A row or a command that does not fit is left out and counted.
[[nodiscard]] std::string diff_set_markdown(const DiffSet& set, std::size_t longest = kLongestComment);

}  // namespace umbra
