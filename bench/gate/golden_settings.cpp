#include "umbra/bench/gate/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "umbra/bench/gate/golden_planes.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr std::array kSettings = {
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,filter=pcf,radius=2"},
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,filter=pcf,radius=1,bilinear=false"},
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,bias=receiver_plane"},
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,bias=manual"},
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,bias=manual,constant=4"},
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,bias=manual,constant=0,slope=0.5"},
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,bias=manual,normal_offset=4"},
    GoldenSetting{"stairs", "shadow_zbuffer:resolution=256,fit=scene"},
    GoldenSetting{"self_shadow", "shadow_zbuffer:resolution=256,depth=16,bias=manual,constant=0"},
    GoldenSetting{"self_shadow", "shadow_zbuffer:resolution=256,depth=24,bias=manual,constant=0"},
    GoldenSetting{"self_shadow", "shadow_zbuffer:resolution=256,faces=back"},
    GoldenSetting{"self_shadow", "shadow_zbuffer:resolution=256,faces=front,bias=manual,constant=0"},
    GoldenSetting{"spot_stage", "shadow_zbuffer:resolution=256,surround=0.1"},
    GoldenSetting{"spot_stage", "shadow_zbuffer:resolution=256,surround=0"},
    GoldenSetting{"eye_in_shadow", "shadow_volumes:counting=depth_fail"},
    GoldenSetting{"faulty_meshes", "shadow_volumes:counting=depth_fail,edges=per_triangle"},
    GoldenSetting{"interpenetrating", "shadow_volumes:edges=silhouette"},
    GoldenSetting{"self_shadow", "ray_traced:offset=epsilon,epsilon=0.01"},
    GoldenSetting{"self_shadow", "ray_traced:offset=integer_offset"},
    GoldenSetting{"umbra_penumbra", "ray_traced:samples=4"},
    GoldenSetting{"umbra_penumbra", "ray_traced:samples=4,seed=1"},
    GoldenSetting{"umbra_penumbra", "ray_traced:samples=9,sampler=stratified"},
    GoldenSetting{"umbra_penumbra", "ray_traced:samples=4,sampler=random"},
    GoldenSetting{"umbra_penumbra", "ray_traced:samples=9,sampler=regular"},
    GoldenSetting{"umbra_penumbra", "ray_traced:samples=4,sampler=r2"},
    GoldenSetting{"umbra_penumbra", "ray_traced:samples=16,measure=irradiance"},
    GoldenSetting{"umbra_penumbra", "planar_projection:light_samples=5"},
    GoldenSetting{"eclipse", "planar_projection:light_samples=5"},
    GoldenSetting{"light_sizes", "planar_projection:light_samples=5"},
    GoldenSetting{"light_sizes", "ray_traced:samples=4"},
    GoldenSetting{"eclipse", "ray_traced:samples=4"},
};

std::string file_name(std::string_view method) {
    std::string name(method);
    std::replace(name.begin(), name.end(), ':', '.');
    return name + ".exr";
}

std::optional<GoldenChange> setting_change(const PreparedScene& prepared, std::string_view method,
                                           const GoldenOptions& options) {
    const std::string& name = prepared.scene.name;
    const fs::path file     = options.folder / name / "settings" / file_name(method);
    const Image now         = coded_planes(prepared, run_once(parse_method(method), prepared), true);
    const bool kept         = fs::exists(file);
    const Image before      = kept ? read_image(file).image : Image(now.width, now.height, {});
    Changes changes         = plane_changes(before, now, prepared);
    if (changes.lines.empty()) return std::nullopt;

    const auto made_on = before.metadata.find("umbra:machine");
    const bool rounding =
        kept && changes.at_edges_alone && made_on != before.metadata.end() && made_on->second != rounding_machine();
    GoldenChange change{
        .name     = fmt::format("{}/{}", name, method),
        .kind     = kept ? GoldenChange::Kind::changed : GoldenChange::Kind::added,
        .lines    = std::move(changes.lines),
        .pictures = leave_pictures(options.pictures, file.stem().string(), prepared, before, now, changes.planes),
        .rounding = rounding};
    if (options.renew) {
        fs::create_directories(file.parent_path());
        Image accepted                     = now;
        accepted.metadata["umbra:method"]  = method;
        accepted.metadata["umbra:machine"] = rounding_machine();
        write_image(file, accepted);
    }
    return change;
}

}  // namespace

std::span<const GoldenSetting> golden_settings() { return kSettings; }

std::vector<GoldenChange> setting_changes(const fs::path& scene, const GoldenOptions& options) {
    const std::string name = scene.stem().string();
    const fs::path folder  = options.folder / name / "settings";
    std::vector<GoldenChange> changes;
    std::set<std::string> files;
    std::optional<PreparedScene> prepared;
    for (const GoldenSetting& s : kSettings) {
        if (s.scene != name) continue;
        files.insert(file_name(s.method));
        const std::string_view method = s.method.substr(0, s.method.find(':'));
        if (!is_wanted(options, name, method) && !is_wanted(options, name, s.method)) continue;
        if (!prepared) prepared.emplace(prepare_scene(scene, kGoldenSize));
        if (auto change = setting_change(*prepared, s.method, options)) changes.push_back(std::move(*change));
    }
    if (!options.names.empty() || !fs::exists(folder)) return changes;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (files.contains(entry.path().filename().string())) continue;
        changes.push_back({.name  = fmt::format("{}/settings/{}", name, entry.path().filename().string()),
                           .kind  = GoldenChange::Kind::removed,
                           .lines = {"unknown settings"}});
        if (options.renew) fs::remove(entry.path());
    }
    return changes;
}

}  // namespace umbra
