#include "umbra/bench/base/files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/cli/lit_polygons.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/shadows/atherton/atherton_weiler.h"

namespace umbra {

Action polygons_command(CLI::App& app, const Common& common) {
    struct Line {
        std::string scene;
        std::filesystem::path out;
        bool as_json = false;
    };
    const auto line = std::make_shared<Line>();
    add_scene(app, line->scene)->required();
    add_json(app, line->as_json);
    add_output(app, line->out);
    return [line, &common] {
        const PreparedScene prepared = prepare_scene(scene_file(line->scene, common.up), {});
        if (const Service service = verdict(*atherton_weiler.make(), prepared.facts); !service) {
            print_error("no lit polygons of this scene: {}\n", service.why);
            return kNo;
        }
        StagedFolder staged(line->out);
        const LitPolygonsRecord record = write_lit_polygons(prepared.scene, prepared.facts, staged.folder());
        write_text(staged.folder() / "results.json", json_text(to_record(record)));
        staged.commit();
        print_record(line->as_json, common, to_record(record), [&] { return lit_polygons_text(record); });
        return kDone;
    };
}

}  // namespace umbra
