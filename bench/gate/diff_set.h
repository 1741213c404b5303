// Two images, or all images of two folders: the pairs and their differences.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "umbra/bench/gate/diff.h"

namespace umbra {

struct DiffSet {
    std::string a, b;
    bool folders = false;            ///< else exactly one pair
    std::vector<DiffResult> images;  ///< folders: sorted by name, the image's path inside its folder

    [[nodiscard]] Verdict worst() const;  ///< the largest
    [[nodiscard]] std::size_t count(Verdict verdict) const;
};

/// Two files are compared by diff(). Of two folders, each image file in either, however deep, is compared with the file
/// of the same relative path in the other; one that is missing there differs, also where A itself is missing. With
/// folders, `options.map` is a folder for a NAME.png of each pair that is not the same, and `options.pictures` a folder
/// for NAME.a.png and so on; with files, `options.pictures` is such a folder too. `progress` receives each name; may be
/// empty. Throws UsageError where one is a folder and the other is not, InputError where a folder has no images or
/// pictures cannot be written.
[[nodiscard]] DiffSet diff_set(const std::filesystem::path& a, const std::filesystem::path& b,
                               const DiffOptions& options, const std::function<void(const std::string&)>& progress);

/// One line an image and one with the counts; a single pair as diff_text. Then the commands that accept the changes.
[[nodiscard]] std::string diff_set_text(const DiffSet& set);

/// {verdict, exit_code, a, b, counts, images: [...]}; a single pair as diff_json.
[[nodiscard]] nlohmann::json diff_set_json(const DiffSet& set);

/// JUnit XML: a test case an image; `failure` where it differs or cannot be compared, `error` where a file cannot be
/// read, each with the figures and the worst pixel. The dialect of Jenkins and GitLab.
[[nodiscard]] std::string diff_set_junit(const DiffSet& set);

}  // namespace umbra
