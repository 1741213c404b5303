// A study as one value: sentences, tables with typed columns, curves and pictures. The text for a terminal, the page,
// and the CSV files are made of it; results.json is the record that it shows.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/lab/describe.h"

namespace umbra {

/// How the values of a column are written.
struct Notation {
    enum class Kind : std::uint8_t { text, code, count, general, fixed, significant } kind = Kind::text;
    int digits = 0;  ///< after the point of `fixed`
};
inline constexpr Notation kWords{Notation::Kind::text}, kCode{Notation::Kind::code}, kCount{Notation::Kind::count},
    kGeneral{Notation::Kind::general}, kSignificant{Notation::Kind::significant};
[[nodiscard]] constexpr Notation decimals(int digits) { return {Notation::Kind::fixed, digits}; }

/// Where something is shown. CSV files have every column of every table.
enum class Shown : std::uint8_t { everywhere, on_page, in_terminal, in_file };

/// Heads and captions mark `code`, and X_j as a subscript.
struct Column {
    std::string key;  ///< of the value in a row, with dots between nested members; the head in CSV
    std::string head;
    Notation notation{};
    std::string unit{};
    std::string group{};  ///< a head over neighbouring columns of the same group
    Shown shown = Shown::everywhere;
    std::string link{};  ///< key of what a cell leads to: a section's id, or, with a "/", a page; empty: none
};

struct StudyTable {
    std::string name;  ///< of its file NAME.csv, and in templates: {{#tables.NAME}}
    std::string caption;
    std::vector<Column> columns;  ///< the first names the row
    Json rows;                    ///< objects; a value that is null or absent is not known
    Shown shown = Shown::everywhere;
};

struct StudyPicture {
    std::string file, alt, caption;
};

/// Values over steps 0, 1, ..., on a logarithmic axis.
struct StudyCurve {
    std::string steps, values, caption;  ///< titles of the axes, and of the curve
    std::vector<double> at;
};

struct StudySentence {
    std::string text;
    Shown shown = Shown::everywhere;
};

struct StudyReport {
    std::string title;      ///< of the browser's tab
    std::string_view page;  ///< the template: sees `tables`, `pictures`, `curves`, `sentences` and `words`
    std::vector<StudyTable> tables{};
    std::map<std::string, std::vector<StudyPicture>> pictures{};  ///< {{#pictures.NAME}}{{>study_picture}}
    std::vector<StudyCurve> curves{};
    std::vector<StudySentence> sentences{};
    Json words = Json::object();  ///< of the template's own prose
};

/// A table as the template `study_table` shows it.
[[nodiscard]] Json table_view(const StudyTable& table);

/// Tables, then sentences, as a terminal shows them.
[[nodiscard]] std::string study_text(const StudyReport& report);

/// Names of columns, then a line a row: numbers in full, text quoted where it must be.
[[nodiscard]] std::string table_csv(const StudyTable& table);

/// FOLDER/index.html and its style. The command and the version are at the foot.
void write_study_page(const StudyReport& report, const HeadRecord& head, const std::filesystem::path& folder,
                      StagedFiles& staged);

/// A record that a study writes: `csv`, its last member, names the files of the tables.
template <class Record>
concept StudyRecord = requires(Record& record) {
    record.head.command;
    record.csv.emplace_back("");
};

/// The page, a CSV file a table, and results.json, whose member `csv` names these files.
template <StudyRecord Record>
void write_study_files(const StudyReport& report, Record& record, const std::filesystem::path& folder,
                       StagedFiles& staged) {
    for (const StudyTable& table : report.tables)
        staged.write(folder / record.csv.emplace_back(table.name + ".csv"), table_csv(table));
    staged.write(folder / "results.json", json_text(to_record(record)));
    write_study_page(report, record.head, folder, staged);
}

/// Writes the folder `out` whole or not at all: `make`, called with `given` and a folder, writes pictures into that and
/// returns the record, `report` says what is shown of it. Returns the record. Throws InputError, and what the two throw.
template <class Make, class Report, class... Given>
auto write_study(const std::filesystem::path& out, const Make& make, const Report& report, const Given&... given) {
    StagedFolder folder(out);
    auto record = make(given..., folder.folder());
    StagedFiles files;
    write_study_files(report(record), record, folder.folder(), files);
    files.commit();
    folder.commit();
    return record;
}

}  // namespace umbra
