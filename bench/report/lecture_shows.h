// The topics of the lectures, of bench/report/lectures/topics.json: where they come from, what shows and tests them, and
// which pictures and figures show one where the reference's picture of its scene does not.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/base/field.h"
#include "umbra/bench/report/lecture_texts.h"

namespace umbra {

/// Something in a results.json. `path` names members, and entries of arrays by their `name` or their number, with dots
/// between: "models.gouraud.picture", "depths.0.picture".
struct LectureValue {
    std::string name;  ///< in English; may be empty
    std::string path;
    std::string frame{};  ///< "@1": of the results.json of that frame of the scene
};

/// A measured property, of one thing or of several that the page names.
struct LectureFigure {
    std::string what;
    std::string kind;  ///< "score", "count" or "percent": how the page writes it
    std::vector<LectureValue> values;
};

struct LectureShow {
    std::string study;  ///< the command that wrote the results.json of the topic's scene; empty: `umbra compare`
    std::vector<LectureValue> pictures;
    std::vector<LectureFigure> figures;
    bool shadows = true;  ///< false: shading is compared without them
};

/// `scene` is empty where no scene shows the topic; `test` checks it and the file `code` computes it. Without a `show`
/// the reference's picture of the scene shows it.
struct LectureRow {
    std::string id, source, scene, test, code, state;
    std::optional<LectureShow> show;
};

/// In the lectures' order.
[[nodiscard]] const std::vector<LectureRow>& lecture_rows();

/// Absent where the record has no such thing.
[[nodiscard]] Field value_at(const Field& root, std::string_view path);

/// "What – first: 0.12; second: 0.34."; "What: 0.12." of a value without a name. Those that are absent are left out; empty
/// where all are. `root_of` gives the results.json of a frame.
[[nodiscard]] std::string figure_in_words(const LectureFigure& figure,
                                          const std::function<Field(const std::string& frame)>& root_of,
                                          Language language);

/// A number as text, as the language writes it; one with three digits.
[[nodiscard]] std::string number_in_words(const std::string& number, Language language);
[[nodiscard]] std::string score_in_words(std::optional<double> value, Language language);

}  // namespace umbra
