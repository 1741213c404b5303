#include "umbra/bench/pages/record_folder.h"

#include "umbra/bench/out/files.h"
#include "umbra/bench/out/staged_folder.h"

namespace umbra {

namespace fs = std::filesystem;

Json write_record_folder(const fs::path& out, const std::function<Json(const fs::path&)>& make,
                         const std::function<void(const Json&, const fs::path&, StagedFiles&)>& add_page) {
    StagedFolder staged(out);
    Json record = make(staged.folder());
    write_text(staged.folder() / "results.json", json_text(record));
    StagedFiles page;
    add_page(record, staged.folder(), page);
    page.commit();
    staged.commit();
    return record;
}

}  // namespace umbra
