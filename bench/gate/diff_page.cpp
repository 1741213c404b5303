#include "umbra/bench/gate/diff_views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "report_assets.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/gate/diff_record.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json image_view(const DiffResult& image, std::size_t index, const fs::path& pictures) {
    json view = {{"name", utf8_text(image.name)},
                 {"id", fmt::format("image-{}", index + 1)},
                 {"verdict", to_string(image.verdict)},
                 {"reasons", utf8_text(fmt::format("{}", fmt::join(image.reasons, "; ")))},
                 {"notes", utf8_text(fmt::format("{}", fmt::join(image.notes, "; ")))},
                 {"worst", worst_pixel(image)},
                 {"measured", false},
                 {"conceded", needed_concessions(image.rules)},
                 {"accept", utf8_text(image.accept)},
                 {"rule_name", utf8_text(image.rule_name)},
                 {"rules", json::array()},
                 {"pictures", false}};
    for (const RuleOutcome& rule : image.rules)
        view["rules"].push_back({{"rule", rule.rule},
                                 {"inside", fmt::format("{}", rule.depth)},
                                 {"holds", rule.holds},
                                 {"says", utf8_text(rule.says)}});
    if (!image.comparable()) return view;
    const ImageError& e = image.error;
    view["measured"]    = json{{"max", score(e.max)},
                            {"rmse", score(e.rmse)},
                            {"mae", score(e.mae)},
                            {"psnr", std::isfinite(e.psnr) ? fmt::format("{:.2f} dB", e.psnr) : "∞"},
                            {"ssim", fmt::format("{:.4f}", image.ssim)},
                            {"flip", score(image.flip.mean)},
                            {"layer", utf8_text(layer_of_flip(image))},
                            {"pixels", count(double(e.differing))},
                            {"over", count(double(e.over))},
                            {"size", fmt::format("{} × {}", image.width, image.height)},
                            {"channels", utf8_text(fmt::format("{}", fmt::join(all_channels(image), " ")))}};
    if (image.verdict == Verdict::same) return view;
    const std::string source = (pictures / image.name).string();
    view["pictures"]         = json{{"a", url(source + ".a.png")},
                            {"b", url(source + ".b.png")},
                            {"map", url(source + ".map.png")},
                            {"file_a", utf8_text(image.a)},
                            {"file_b", utf8_text(image.b)},
                            {"range", image.map_range > 0 ? fmt::format("{:g}", image.map_range) : ""},
                            {"width", std::to_string(image.width)},
                            {"height", std::to_string(image.height)}};
    return view;
}

}  // namespace

fs::path diff_pictures_folder(const fs::path& file) { return fs::path(file).replace_extension(".files"); }

void write_diff_page(const fs::path& file, const DiffSet& set) {
    const fs::path pictures = diff_pictures_folder(file).filename();
    json images             = json::array();
    for (std::size_t i = 0; i < set.images.size(); ++i) images.push_back(image_view(set.images[i], i, pictures));
    std::string accept;
    for (const DiffResult& image : set.images)
        if (!image.accept.empty()) accept += image.accept + "\n";
    const std::size_t fine = set.count(Verdict::same) + set.count(Verdict::close);
    StagedFiles staged;
    staged.write(file, render_page(assets::diff_html, {},
                                   {{"a", utf8_text(set.a)},
                                    {"b", utf8_text(set.b)},
                                    {"verdict", to_string(set.worst())},
                                    {"count", count(double(set.images.size()))},
                                    {"bad", count(double(set.images.size() - fine))},
                                    {"accept", utf8_text(accept)},
                                    {"many", set.images.size() != 1},
                                    {"images", std::move(images)}}));
    staged.commit();
}

}  // namespace umbra
