// The languages of the page of the lectures, with the lectures' own terms: a folder each in bench/report/lectures/.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace umbra {

struct Language {
    std::string_view code;  ///< its folder, and its name in HTML: "en"

    bool operator==(const Language&) const = default;
    static const Language english;
};
inline constexpr Language Language::english{"en"};

/// Those that have a folder, by their codes.
[[nodiscard]] const std::vector<Language>& languages();
/// Nothing for one without a folder.
[[nodiscard]] std::optional<Language> language_named(std::string_view code);

/// The language of FOLDER/texts.json, called as the folder; what the file does not translate stays English. Throws InputError
/// where it says what English has not, or in another type.
[[nodiscard]] Language add_language(const std::filesystem::path& folder);

/// Its texts.json: {decimal_comma, phrases, chapters: {A: {title, exercises: [{question, answer}]}}, topics: {A1: {topic,
/// proves}}, course, names}. `proves` is what the picture of a topic's scene shows; absent where no scene shows it. `names`
/// translates what topics.json calls pictures, figures and sources; English has none.
[[nodiscard]] const nlohmann::json& lecture_words(Language language);

/// A name of topics.json or experiments.json in the language. One that `names` lacks, such as "n = 0.5", has the
/// language's decimal comma and, where that is one, the language's separator between the numbers of a formula.
[[nodiscard]] std::string lecture_name(const std::string& english, Language language);

/// Between two figures of a list: "; " in English.
[[nodiscard]] std::string separator(Language language);

}  // namespace umbra
