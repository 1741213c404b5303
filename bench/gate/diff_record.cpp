#include "umbra/bench/gate/diff_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

std::string digits(double x) { return fmt::format("{:.6g}", x); }

}  // namespace

std::string worst_pixel(const DiffResult& result) {
    if (!result.comparable() || !result.any_difference()) return "";
    if (result.error.differing == 0) {
        const IntegerDiff& d = *std::find_if(result.integers.begin(), result.integers.end(),
                                             [](const IntegerDiff& i) { return i.differing > 0; });
        return fmt::format("({}, {}), channel {}: A {}, B {}", d.x, d.y, d.name, d.a, d.b);
    }
    const auto& w = result.worst;
    return fmt::format("({}, {}), channel {}: A {}, B {}", w.x, w.y, result.channels[w.channel], digits(w.a),
                       digits(w.b));
}

std::string layer_of_flip(const DiffResult& result) {
    if (result.layers.size() < 2) return "";
    return fmt::format("{}, worst of {} layers", result.layers[result.worst_layer].name, result.layers.size());
}

std::vector<std::string> all_channels(const DiffResult& result) {
    std::vector<std::string> names = result.channels;
    for (const IntegerDiff& integer : result.integers)
        if (std::find(names.begin(), names.end(), integer.name) == names.end()) names.push_back(integer.name);
    return names;
}

std::string diff_text(const DiffResult& result) {
    std::string text;
    const auto line = [&]<class... Values>(fmt::format_string<Values...> format, Values&&... values) {
        text += fmt::format(format, std::forward<Values>(values)...) + '\n';
    };
    if (result.comparable()) {
        const ImageError& e = result.error;
        const double pixels = double(result.flip.map.size());
        line("{} against {}: {}x{}, {}", result.a, result.b, result.width, result.height,
             fmt::join(all_channels(result), " "));
        line("  MAE     {}", digits(e.mae));
        line("  RMSE    {}", digits(e.rmse));
        line("  PSNR    {}", std::isfinite(e.psnr) ? digits(e.psnr) + " dB" : "infinite");
        line("  max     {}", digits(e.max));
        if (const std::string worst = worst_pixel(result); !worst.empty()) line("  worst   {}", worst);
        const std::string of_layer = layer_of_flip(result);
        line("  SSIM    {}{}", digits(result.ssim),
             of_layer.empty() ? "" : fmt::format(" (least of {} layers)", result.layers.size()));
        line("  FLIP    {} (mean, {}{}), weighted median {}, quartiles {} and {}, max {}", digits(result.flip.mean),
             result.hdr ? "HDR" : "LDR", of_layer.empty() ? "" : "; " + of_layer, digits(result.flip.weighted_median),
             digits(result.flip.first_quartile), digits(result.flip.third_quartile), digits(result.flip.max));
        line("  pixels  {} differ ({:.3g} %), {} beyond the limit ({:.3g} %)", e.differing,
             100 * double(e.differing) / pixels, e.over, 100 * double(e.over) / pixels);
        if (e.not_finite > 0)
            line("  {} values are not finite, {} of them unlike in the two", e.not_finite, e.unlike_not_finite);
        if (result.channels.size() > 3 && e.differing > 0)
            for (std::size_t c = 0; c < result.channels.size(); ++c)
                if (const ImageError& of = result.channel_error[c]; of.differing > 0)
                    line("  {}: MAE {}, RMSE {}, max {} at ({}, {})", result.channels[c], digits(of.mae),
                         digits(of.rmse), digits(of.max), of.worst.x, of.worst.y);
        if (result.layers.size() > 1)
            for (const LayerDiff& layer : result.layers)
                if (layer.flip > 0 || layer.ssim < 1)
                    line("  layer {}: SSIM {}, FLIP {}", layer.name, digits(layer.ssim), digits(layer.flip));
    }
    if (result.map_range > 0)
        line(
            "  map     B - A, the channel with the largest difference: blue -{0:g} to red +{0:g}; small groups of "
            "pixels "
            "are ringed",
            result.map_range);
    if (!result.rules.empty()) line("  rules for {}:", result.rule_name);
    for (const RuleOutcome& rule : result.rules)
        line("    {:{}}{}: {}, {}", "", 2 * rule.depth, rule.rule, rule.holds ? "holds" : "does not hold", rule.says);
    for (const std::string& note : result.notes) line("  note: {}", note);
    line("{}{}{}", to_string(result.verdict), result.reasons.empty() ? "" : ": ", fmt::join(result.reasons, "; "));
    return text;
}

std::string diff_line(const DiffResult& result) {
    std::string line = fmt::format("{:<10} {}", to_string(result.verdict), result.name);
    if (!result.reasons.empty()) line += fmt::format(": {}", fmt::join(result.reasons, "; "));
    if (const std::string by = needed_concessions(result.rules); !by.empty()) line += "; " + by;
    if (const std::string worst = worst_pixel(result); !worst.empty()) line += "; worst " + worst;
    return line;
}

nlohmann::json diff_json(const DiffResult& result) {
    nlohmann::json json{{"verdict", to_string(result.verdict)},
                        {"exit_code", int(result.verdict)},
                        {"name", result.name},
                        {"a", result.a},
                        {"b", result.b},
                        {"reasons", result.reasons},
                        {"notes", result.notes},
                        {"accept", result.accept}};
    if (!result.rules.empty()) {
        json["rules"] = {{"name", result.rule_name}, {"outcomes", nlohmann::json::array()}};
        for (const RuleOutcome& rule : result.rules)
            json["rules"]["outcomes"].push_back(nlohmann::json(to_record(rule)));
    }
    if (!result.comparable()) return json;
    const ImageError& e       = result.error;
    json["size"]              = {result.width, result.height};
    json["mae"]               = e.mae;
    json["rmse"]              = e.rmse;
    json["max"]               = e.max;
    json["psnr"]              = std::isfinite(e.psnr) ? nlohmann::json(e.psnr) : nlohmann::json();
    json["ssim"]              = result.ssim;
    json["flip"]              = {{"mean", result.flip.mean},
                                 {"weighted_median", result.flip.weighted_median},
                                 {"first_quartile", result.flip.first_quartile},
                                 {"third_quartile", result.flip.third_quartile},
                                 {"min", result.flip.min},
                                 {"max", result.flip.max},
                                 {"kind", result.hdr ? "hdr" : "ldr"}};
    json["worst"]             = {{"x", result.worst.x},
                                 {"y", result.worst.y},
                                 {"channel", result.channels[result.worst.channel]},
                                 {"a", result.worst.a},
                                 {"b", result.worst.b}};
    json["differing_pixels"]  = e.differing;
    json["pixels_over"]       = e.over;
    json["not_finite"]        = e.not_finite;
    json["unlike_not_finite"] = e.unlike_not_finite;
    json["layers"]            = nlohmann::json::array();
    for (const LayerDiff& of : result.layers)
        json["layers"].push_back({{"name", of.name}, {"ssim", of.ssim}, {"flip", of.flip}});
    json["integers"] = nlohmann::json::array();
    for (const IntegerDiff& of : result.integers)
        json["integers"].push_back({{"name", of.name}, {"differing_pixels", of.differing}});
    json["channels"] = nlohmann::json::array();
    for (std::size_t c = 0; c < result.channels.size(); ++c) {
        const ImageError& of = result.channel_error[c];
        json["channels"].push_back({{"name", result.channels[c]}, {"mae", of.mae}, {"rmse", of.rmse}, {"max", of.max}});
    }
    return json;
}

}  // namespace umbra
