#include "umbra/bench/compare/method_files.h"

#include <fmt/format.h>

#include <functional>
#include <utility>
#include <vector>

#include "umbra/bench/compare/exr_layers.h"
#include "umbra/bench/compare/pictures.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace {

/// All but the map of FLIP. `explained` is empty for the reference, which has nothing to differ from.
FilesRecord write_files(const FilePlace& place, const PreparedScene& prepared, const Answers& method,
                        const MethodRun& reference, std::span<const Explained> explained) {
    const Scene& scene       = prepared.scene;
    const PointBatch& points = prepared.points;
    const MethodRun& run     = method.run;
    FilesRecord files{.exr = {place.id + ".exr"}, .png = {place.id + ".png"}};

    const bool is_reference = explained.empty();
    Image full              = exr_image(method.rendered.linear, scene, points, run,
                                        {.geometry = is_reference, .reference = is_reference, .explained = explained});
    full.metadata.merge(run_metadata(scene, run.choice, place.command));
    const Image shown = picture_of(prepared, run, method.rendered, method.fine);
    // Packing them takes longer than making them: several at a time.
    std::vector<std::pair<std::string, std::function<Image()>>> pictures;
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        const std::string& light = scene.lights[j].name;
        LightFilesRecord entry{.visibility = {fmt::format("{}.S.{}.png", place.id, light)}};
        pictures.emplace_back(entry.visibility.name, [&, j] { return visibility_picture(points, run.planes[j]); });
        if (!is_reference) {
            entry.difference = {fmt::format("{}.diff.{}.png", place.id, light)};
            pictures.emplace_back(entry.difference.name,
                                  [&, j] { return difference_picture(points, j, run.planes[j], reference.planes[j]); });
            entry.classes = {fmt::format("{}.classes.{}.png", place.id, light)};
            pictures.emplace_back(entry.classes.name,
                                  [&, j] { return class_picture(points, explained[j].classes, reference.planes[j]); });
        }
        files.lights.emplace_back(light, std::move(entry));
    }
    parallel_ranges(pictures.size() + 2, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (k == 0)
                write_image(place.folder / files.exr.name, full);
            else if (k == 1)
                write_image(place.folder / files.png.name, shown);
            else
                write_image(place.folder / pictures[k - 2].first, pictures[k - 2].second());
        }
    });
    return files;
}

}  // namespace

std::map<std::string, std::string> run_metadata(const Scene& scene, const MethodChoice& choice,
                                                const std::string& command) {
    std::map<std::string, std::string> metadata{{"umbra:scene", scene.source},
                                                {"umbra:method", std::string(choice.info->name)},
                                                {"umbra:parameters", choice.text()},
                                                {"umbra:version", std::string(version())},
                                                {"umbra:command", command}};
    if (const dvec3 o = scene.origin; o != dvec3(0)) metadata["umbra:origin"] = fmt::format("{} {} {}", o.x, o.y, o.z);
    return metadata;
}

void remove_files_of(const std::filesystem::path& folder, const std::string& id) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename().string().starts_with(id + ".")) files.push_back(entry.path());
    for (const std::filesystem::path& file : files) std::filesystem::remove(file);
}

FilesRecord write_reference_files(const FilePlace& place, const PreparedScene& prepared, const Answers& reference) {
    return write_files(place, prepared, reference, reference.run, {});
}

ComparedFiles write_compared_files(const FilePlace& place, const PreparedScene& prepared, const Answers& method,
                                   const Answers& reference, std::span<const Explained> explained) {
    const std::string map = place.id + ".flip.png";
    ComparedFiles written;
    // Each has parts that one thread does alone.
    parallel_pair([&] { written.files = write_files(place, prepared, method, reference.run, explained); },
                  [&] {
                      const ImageFigures found = image_figures(method.run.planes, method.rendered, reference.rendered);
                      write_image(place.folder / map, flip_picture(prepared.points, method.run.planes, found.flip.map));
                      written.image = found.figures;
                  });
    written.files.flip = {map};
    return written;
}

}  // namespace umbra
