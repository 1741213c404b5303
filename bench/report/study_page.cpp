#include "umbra/bench/report/study_page.h"

#include <utility>

#include "umbra/bench/out/files.h"
#include "umbra/bench/out/place_lock.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {

namespace fs = std::filesystem;

std::optional<StudyPage> read_study(const Field& root, const fs::path& file) {
    for (const auto& [member, command] : {std::pair{"models", "shading"}, {"ways", "whitted"}, {"unshot", "radiosity"}})
        if (root[member].present()) {
            StudyPage study{.command = command,
                            .scene   = {.root  = root,
                                        .data  = fs::canonical(file.parent_path()),
                                        .page  = {},
                                        .name  = root["scene"]["name"].required_text(),
                                        .title = root["scene"]["title"].text()}};
            study.scene.results.size = from_record<SizeRecord>(root["size"]);
            if (study.scene.title.empty()) study.scene.title = in_words(study.scene.name);
            return study;
        }
    return std::nullopt;
}

void take_study(StudyPage& study, const fs::path& out, StagedFiles& staged) {
    const fs::path relative = study.scene.data.lexically_relative(out);
    study.scene.page        = study.scene.data;
    if (relative != "." && *relative.begin() != "..") return;
    study.scene.page = out / folder_name(study.command + "-" + study.scene.name);
    for (const auto& entry : fs::directory_iterator(study.scene.data))
        if (entry.is_regular_file() && !is_hidden_name_of_ours(entry.path()))
            staged.copy(entry.path(), study.scene.page / entry.path().filename());
}

}  // namespace umbra
