// The EXR and the PNGs of one method, and how far its picture is from the reference's.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "umbra/bench/compare/fine_picture.h"
#include "umbra/bench/compare/image_figures.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"

namespace umbra {

/// Where the files of one method go: `folder`, which is there, and what their names begin with.
struct FilePlace {
    std::filesystem::path folder;
    std::string id;
    std::string command;  ///< for the metadata
};

/// A method's answers and the sum of them. `fine` is of the same method or of another one on the same scene, or empty.
struct Answers {
    const MethodRun& run;
    const Rendered& rendered;
    const FinePicture& fine;
};

/// Metadata of a file that one method's answers are in.
[[nodiscard]] std::map<std::string, std::string> run_metadata(const Scene& scene, const MethodChoice& choice,
                                                              const std::string& command);

/// Removes the files of one method from the folder.
void remove_files_of(const std::filesystem::path& folder, const std::string& id);

/// Writes the reference's files and returns their names. Throws InputError where one cannot be written.
FilesRecord write_reference_files(const FilePlace& place, const PreparedScene& prepared, const Answers& reference);

/// Writes a method's files, among them the map of FLIP, and returns their names and the differences of the pictures.
/// `explained` is one a light. Throws InputError where one cannot be written.
struct ComparedFiles {
    FilesRecord files;
    ImageRecord image;
};
ComparedFiles write_compared_files(const FilePlace& place, const PreparedScene& prepared, const Answers& method,
                                   const Answers& reference, std::span<const Explained> explained);

}  // namespace umbra
