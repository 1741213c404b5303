// The words of the page of the lectures in English, German and Greek, with the lectures' own terms.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace umbra {

enum class Language { english, german, greek };

/// "en", "de" or "el"; nothing for others.
[[nodiscard]] std::optional<Language> language_named(std::string_view code);
[[nodiscard]] std::string_view code_of(Language language);

struct Translated {
    std::string_view en{}, de{}, el{};

    [[nodiscard]] std::string_view in(Language language) const;
};

/// One topic of docs/lectures.md. `proves` is what the picture of its scene shows; empty where no scene shows it.
struct LectureText {
    std::string_view id;
    std::string_view german, greek;  ///< the topic; in English it is in docs/lectures.md
    Translated proves;
};

struct Exercise {
    Translated question, answer;
};

/// A chapter: the rows whose ids begin with its letter, and exercises.
struct LectureChapter {
    char letter;
    Translated title;
    std::array<Exercise, 2> exercises;
};

/// In the lectures' order.
[[nodiscard]] std::span<const LectureText> lecture_texts();
[[nodiscard]] std::span<const LectureChapter> lecture_chapters();

/// Words of the page that belong to no topic.
struct LecturePhrases {
    Translated title, lead, works, in_part, not_yet, measured, exercise, answer, source, back;
};
[[nodiscard]] const LecturePhrases& lecture_phrases();

}  // namespace umbra
