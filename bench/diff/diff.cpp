#include "umbra/bench/diff/diff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

/// Names of `a` that are not in `b`.
std::vector<std::string> missing(const std::vector<std::string>& a, const std::vector<std::string>& b) {
    std::vector<std::string> names;
    for (const std::string& name : a)
        if (std::find(b.begin(), b.end(), name) == b.end()) names.push_back(name);
    return names;
}

/// Why the two cannot be compared pixel by pixel; empty if they can.
std::vector<std::string> find_unlike(const LoadedImage& a, const LoadedImage& b) {
    std::vector<std::string> reasons;
    if (a.image.width != b.image.width || a.image.height != b.image.height)
        reasons.push_back(fmt::format("sizes differ: {}x{} against {}x{}", a.image.width, a.image.height, b.image.width,
                                      b.image.height));
    if (a.x != b.x || a.y != b.y)
        reasons.push_back(fmt::format("data windows differ: begin at ({}, {}) against ({}, {})", a.x, a.y, b.x, b.y));
    const auto only_a = missing(a.image.channels, b.image.channels);
    const auto only_b = missing(b.image.channels, a.image.channels);
    if (!only_a.empty() || !only_b.empty())
        reasons.push_back(fmt::format("channels differ: only the first has [{}], only the second [{}], both [{}]",
                                      fmt::join(only_a, " "), fmt::join(only_b, " "),
                                      fmt::join(missing(a.image.channels, only_a), " ")));
    return reasons;
}

/// Linear light as an 8- or 16-bit file would hold it. Alpha is not light.
void encode(Image& image) {
    const std::size_t n = image.channels.size();
    for (std::size_t c = 0; c < n; ++c) {
        if (image.channels[c] == "A") continue;
        for (std::size_t i = 0; i < image.pixels(); ++i)
            image.at(i, c) = srgb_from_linear(std::clamp(image.at(i, c), 0.0f, 1.0f));
    }
}

Image one_channel(const Image& image, const std::string& name) {
    const auto c = std::size_t(std::find(image.channels.begin(), image.channels.end(), name) - image.channels.begin());
    Image channel(image.width, image.height, {name});
    for (std::size_t i = 0; i < image.pixels(); ++i) channel.data[i] = image.at(i, c);
    return channel;
}

void measure(DiffResult& result, const Image& a, const Image& b, double fail) {
    result.width    = a.width;
    result.height   = a.height;
    result.channels = a.channels;
    result.error    = image_error(a, b, fail);
    for (const std::string& name : a.channels)
        result.channel_error.push_back(image_error(one_channel(a, name), one_channel(b, name), fail));
    if (result.error.differing == 0) {  // nothing to see, and FLIP takes its time over it
        result.flip.map.resize(a.pixels());
        return;
    }
    result.ssim = ssim(a, b);
    result.flip = result.hdr ? flip_hdr(a, b) : flip_ldr(a, b);
}

/// Same, close or differs; and why.
void judge(DiffResult& result, const DiffOptions& options, double fail, bool asks_fail) {
    const ImageError& e = result.error;
    if (e.unlike_not_finite == 0 && e.max <= options.warn) return;  // same
    const auto limit = [&](bool missed, std::string reason) {
        if (missed) result.reasons.push_back(std::move(reason));
    };
    limit(e.unlike_not_finite > 0,
          fmt::format("{} values are not finite in one image and another in the other", e.unlike_not_finite));
    const double percent = 100 * double(e.over) / double(result.flip.map.size());
    if (asks_fail && e.max > fail)
        limit(percent > options.fail_percent,
              options.fail_percent > 0 ? fmt::format("{:.4g} % of the pixels differ by more than {} (allowed: {} %)",
                                                     percent, fail, options.fail_percent)
                                       : fmt::format("largest difference {:.6g} is above {}", e.max, fail));
    if (const auto& x = options.fail_rmse) limit(e.rmse > *x, fmt::format("RMSE {:.6g} is above {}", e.rmse, *x));
    if (const auto& x = options.fail_flip)
        limit(result.flip.mean > *x, fmt::format("mean FLIP {:.6g} is above {}", result.flip.mean, *x));
    if (const auto& x = options.fail_psnr) limit(e.psnr < *x, fmt::format("PSNR {:.6g} dB is below {}", e.psnr, *x));
    if (const auto& x = options.fail_ssim)
        limit(result.ssim < *x, fmt::format("SSIM {:.6g} is below {}", result.ssim, *x));
    result.verdict = result.reasons.empty() ? Verdict::close : Verdict::differs;
}

void write_map(const std::filesystem::path& file, const DiffResult& result, const Image& a, const Image& b) {
    std::vector<std::string> names{"FLIP"};
    if (file.extension() == ".exr")
        for (const std::string& name : a.channels) names.push_back("difference." + name);
    Image map(a.width, a.height, names);
    map.metadata = {{"umbra:difference", result.b + " minus " + result.a}};
    for (std::size_t i = 0; i < map.pixels(); ++i) map.at(i, 0) = result.flip.map[i];
    for (std::size_t c = 1; c < names.size(); ++c) {
        const Image of_a = one_channel(a, a.channels[c - 1]);
        const Image of_b = one_channel(b, a.channels[c - 1]);
        for (std::size_t i = 0; i < map.pixels(); ++i) map.at(i, c) = of_b.data[i] - of_a.data[i];
    }
    write_image(file, map);
}

std::string number(double x) { return fmt::format("{:.6g}", x); }

}  // namespace

std::string_view to_string(Verdict verdict) {
    switch (verdict) {
        case Verdict::same: return "same";
        case Verdict::close: return "close";
        case Verdict::differs: return "differs";
        case Verdict::unlike: return "unlike";
        case Verdict::unreadable: return "unreadable";
    }
    return "";
}

DiffResult diff(const std::filesystem::path& file_a, const std::filesystem::path& file_b, const DiffOptions& options) {
    DiffResult result;
    result.a = file_a.string();
    result.b = file_b.string();

    LoadedImage a, b;
    for (const auto& [file, loaded] : {std::pair{&file_a, &a}, std::pair{&file_b, &b}}) {
        try {
            *loaded = read_image(*file);
        } catch (const InputError& error) {
            result.reasons.emplace_back(error.what());
        }
    }
    if (!result.reasons.empty()) {
        result.verdict = Verdict::unreadable;
        return result;
    }
    result.reasons = find_unlike(a, b);
    if (!result.reasons.empty()) {
        result.verdict = Verdict::unlike;
        return result;
    }
    if (a.encoding != b.encoding) {
        const bool first = a.encoding == Encoding::linear;
        encode(first ? a.image : b.image);
        result.notes.push_back(
            fmt::format("{} holds linear light, the other sRGB: clamped and encoded before comparing",
                        first ? result.a : result.b));
    }
    result.hdr = a.encoding == Encoding::linear && b.encoding == Encoding::linear;

    const bool asks_else = options.fail_rmse || options.fail_flip || options.fail_psnr || options.fail_ssim;
    const double fail    = options.fail.value_or(kDefaultFail);
    measure(result, a.image, b.image, fail);
    judge(result, options, fail, options.fail || !asks_else);
    if (!options.map.empty()) write_map(options.map, result, a.image, b.image);
    return result;
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
             fmt::join(result.channels, " "));
        line("  MAE     {}", number(e.mae));
        line("  RMSE    {}", number(e.rmse));
        line("  PSNR    {}", std::isfinite(e.psnr) ? number(e.psnr) + " dB" : "infinite");
        line("  max     {}{}", number(e.max),
             e.max > 0 ? fmt::format(" at ({}, {}), channel {}", e.worst.x, e.worst.y,
                                     result.channels[std::size_t(e.worst.channel)])
                       : "");
        line("  SSIM    {}", number(result.ssim));
        line("  FLIP    {} (mean, {}), weighted median {}, quartiles {} and {}, max {}", number(result.flip.mean),
             result.hdr ? "HDR" : "LDR", number(result.flip.weighted_median), number(result.flip.first_quartile),
             number(result.flip.third_quartile), number(result.flip.max));
        line("  pixels  {} differ ({:.3g} %), {} beyond the limit ({:.3g} %)", e.differing,
             100 * double(e.differing) / pixels, e.over, 100 * double(e.over) / pixels);
        if (e.not_finite > 0)
            line("  {} values are not finite, {} of them unlike in the two", e.not_finite, e.unlike_not_finite);
        if (result.channels.size() > 3 && e.differing > 0)
            for (std::size_t c = 0; c < result.channels.size(); ++c)
                if (const ImageError& of = result.channel_error[c]; of.differing > 0)
                    line("  {}: MAE {}, RMSE {}, max {} at ({}, {})", result.channels[c], number(of.mae),
                         number(of.rmse), number(of.max), of.worst.x, of.worst.y);
    }
    for (const std::string& note : result.notes) line("  note: {}", note);
    line("{}{}{}", to_string(result.verdict), result.reasons.empty() ? "" : ": ", fmt::join(result.reasons, "; "));
    return text;
}

nlohmann::json diff_json(const DiffResult& result) {
    nlohmann::json json{{"verdict", to_string(result.verdict)},
                        {"exit_code", int(result.verdict)},
                        {"a", result.a},
                        {"b", result.b},
                        {"reasons", result.reasons},
                        {"notes", result.notes}};
    if (!result.comparable()) return json;
    const ImageError& e = result.error;
    json["size"]        = {result.width, result.height};
    json["mae"]         = e.mae;
    json["rmse"]        = e.rmse;
    json["max"]         = e.max;
    json["psnr"]        = std::isfinite(e.psnr) ? nlohmann::json(e.psnr) : nlohmann::json();
    json["ssim"]        = result.ssim;
    json["flip"]        = {{"mean", result.flip.mean},
                           {"weighted_median", result.flip.weighted_median},
                           {"first_quartile", result.flip.first_quartile},
                           {"third_quartile", result.flip.third_quartile},
                           {"min", result.flip.min},
                           {"max", result.flip.max},
                           {"kind", result.hdr ? "hdr" : "ldr"}};
    json["worst"] = {{"x", e.worst.x}, {"y", e.worst.y}, {"channel", result.channels[std::size_t(e.worst.channel)]}};
    json["differing_pixels"]  = e.differing;
    json["pixels_over"]       = e.over;
    json["not_finite"]        = e.not_finite;
    json["unlike_not_finite"] = e.unlike_not_finite;
    json["channels"]          = nlohmann::json::array();
    for (std::size_t c = 0; c < result.channels.size(); ++c) {
        const ImageError& of = result.channel_error[c];
        json["channels"].push_back({{"name", result.channels[c]}, {"mae", of.mae}, {"rmse", of.rmse}, {"max", of.max}});
    }
    return json;
}

}  // namespace umbra
