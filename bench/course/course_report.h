// A lecturer's own report: chapters of text, scenes that are compared, exercises; as a page, and as a PDF.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/compare/compare.h"
#include "umbra/bench/course/rubric.h"
#include "umbra/bench/record/record.h"
#include "umbra/bench/report/lecture_texts.h"

namespace umbra {

struct ExerciseRecord {
    std::string question{}, answer{};
};
template <class Fields>
void describe(Fields& of, Is<ExerciseRecord>) {
    of.name("exercise", "");
    of.must("question", &ExerciseRecord::question, "");
    of.may("answer", &ExerciseRecord::answer, "shown where the course shows answers");
}

struct ChapterRecord {
    std::string title{}, text{};
    std::vector<std::string> scenes{}, methods{};
    std::vector<ExerciseRecord> exercises{};
};
template <class Fields>
void describe(Fields& of, Is<ChapterRecord>) {
    of.name("chapter", "");
    of.must("title", &ChapterRecord::title, "");
    of.may("text", &ChapterRecord::text, "paragraphs are parted by empty lines");
    of("scenes", &ChapterRecord::scenes, "names of scenes, or files beside this one");
    of("methods", &ChapterRecord::methods, "instead of the course's");
    of("exercises", &ChapterRecord::exercises, "");
}

struct CourseRecord {
    std::string title{}, text{}, language{}, size{};
    std::vector<std::string> methods{};
    bool answers = false;
    std::vector<ChapterRecord> chapters{};
};
template <class Fields>
void describe(Fields& of, Is<CourseRecord>) {
    of.name("course", "a report of a lecturer's own");
    of.must("title", &CourseRecord::title, "");
    of.may("text", &CourseRecord::text, "");
    of.may("language", &CourseRecord::language, "en, de, el, or a folder beside this file that holds texts.json");
    of.may("size", &CourseRecord::size, "WIDTHxHEIGHT of all scenes; their own");
    of("methods", &CourseRecord::methods, "those that are compared, with settings; all");
    of.may("answers", &CourseRecord::answers, "true: with the answers of exercises");
    of("chapters", &CourseRecord::chapters, "");
}

struct Course {
    CourseRecord record{};
    std::filesystem::path file{};
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
