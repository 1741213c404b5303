// A lecturer's own report: chapters of text, scenes that are compared, exercises; as a page, and as a PDF.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/bench/report/course/rubric.h"
#include "umbra/bench/report/lecture_texts.h"

namespace umbra {

struct ExerciseRecord {
    std::string question{}, answer{};
};
DESCRIBE(ExerciseRecord) {
    of.name("exercise");
    of.must(MEMBER(question));
    of.may(MEMBER(answer), "shown where the course shows answers");
}

struct ChapterRecord {
    std::string title{}, text{};
    std::vector<std::string> scenes{}, methods{};
    std::vector<ExerciseRecord> exercises{};
};
DESCRIBE(ChapterRecord) {
    of.name("chapter");
    of.must(MEMBER(title));
    of.may(MEMBER(text), "paragraphs are parted by empty lines");
    of(MEMBER(scenes), "names of scenes, or files beside this one");
    of(MEMBER(methods), "instead of the course's");
    MEMBERS(exercises);
}

struct CourseRecord {
    std::string title{}, text{}, language{}, size{};
    std::vector<std::string> methods{};
    bool answers = false;
    std::vector<ChapterRecord> chapters{};
};
DESCRIBE(CourseRecord) {
    of.name("course", "a report of a lecturer's own");
    of.must(MEMBER(title));
    of.may(MEMBER(text));
    of.may(MEMBER(language), "en, de, el, or a folder beside this file that holds texts.json");
    of.may(MEMBER(size), "WIDTHxHEIGHT of all scenes; their own");
    of(MEMBER(methods), "those that are compared, with settings; all");
    of.may(MEMBER(answers), "true: with the answers of exercises");
    MEMBERS(chapters);
}

struct Course {
    CourseRecord record{};
    Language language = Language::english;
    Size size{};
    std::vector<std::vector<std::filesystem::path>> scenes{};  ///< [chapter]
};

/// Reads and checks it: names of methods and scenes, the language. Throws InputError with the file and the position.
[[nodiscard]] Course read_course(const std::filesystem::path& file, const FindScene& find);

/// Compares each scene with the methods of its chapter, once where two chapters have both in common, and writes
/// OUT/index.html, results.json and a folder a comparison. `options` says all but scenes, methods, size and folders.
/// Returns messages: scenes that cannot be read, methods that failed.
[[nodiscard]] std::vector<std::string> write_course(const Course& course, CompareOptions options);

/// OUT/course.pdf of OUT/index.html, through Chromium. Returns why there is none; empty: it is there.
[[nodiscard]] std::string print_course(const std::filesystem::path& out);

}  // namespace umbra
