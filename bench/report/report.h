// The report: pages made from results.json files and the pictures beside them, and from nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/report/lecture_texts.h"

namespace umbra {

struct ReportOptions {
    std::string title = "Shadow methods compared";  ///< heading of the first page
    std::vector<std::string> failed{};              ///< messages for the first page, of scenes that have no results
    std::string so_far{};                           ///< of a run that goes on, for the first page; empty: it has ended
    Language language = Language::english;          ///< of the page of the lectures; all else is in English
    bool with_exr     = true;                       ///< copy the EXRs of scenes whose folder is not in the report's
};

/// Folders that `umbra ladder` wrote may be among them: the first page then says where each method breaks. Of folders
/// that `umbra sweep` wrote, out/trade/index.html shows error against frame cost, and the first page what was found.
/// Where scenes of docs/lectures.md are among them, out/lectures.html shows its topics with their pictures, also with
/// those of folders that `umbra shading`, `umbra whitted` and `umbra radiosity` wrote.
/// Writes out/index.html, a page per scene, their style and their scripts. Reads DIR/<scene>/results.json of each
/// folder, or DIR/results.json where there is none of those. A scene whose folder lies in `out` gets its page beside
/// its pictures; of others the pictures are copied to out/<scene>, so that `out` can be handed out whole. The pages
/// work from disk, name no host, and all links are relative. Everything is checked and written beside before anything
/// is moved into place. Throws InputError naming the file and the position in it, UsageError where no folder is given.
void write_report(const std::vector<std::filesystem::path>& dirs, const std::filesystem::path& out,
                  const ReportOptions& options = {});

/// Writes folder/index.html alone, for a scene that compare wrote to `folder`, which lies in the report's folder.
/// Throws as above.
void write_scene_page(const std::filesystem::path& folder);

/// Style and scripts of such pages, into the folder that theirs lie in.
void write_scene_assets(const std::filesystem::path& folder, StagedFiles& staged);

/// Everything that a page links to or shows exists; false where there is no page.
[[nodiscard]] bool links_hold(const std::filesystem::path& page);

}  // namespace umbra
