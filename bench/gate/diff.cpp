#include "umbra/bench/gate/diff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/base/shell.h"
#include "umbra/bench/gate/difference_map.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"

namespace umbra {
namespace {

/// Names of `a` that are not in `b`.
std::vector<std::string> missing(const std::vector<std::string>& a, const std::vector<std::string>& b) {
    std::vector<std::string> names;
    for (const std::string& name : a)
        if (std::find(b.begin(), b.end(), name) == b.end()) names.push_back(name);
    return names;
}

/// Names of the integers.
std::vector<std::string> integers_of(const Image& image) {
    std::vector<std::string> names;
    for (const auto& integer : image.integers) names.push_back(integer.first);
    return names;
}

/// Names of all channels, integers last.
std::vector<std::string> names_of(const Image& image) {
    std::vector<std::string> names = image.channels;
    for (std::string& name : integers_of(image)) names.push_back(std::move(name));
    return names;
}

/// Why the two cannot be compared pixel by pixel; empty if they can.
std::vector<std::string> find_unlike(const LoadedImage& a, const LoadedImage& b) {
    std::vector<std::string> reasons = layout_differences(a, b);
    const auto only_in               = [](const Image& x, const Image& y) {
        std::vector<std::string> names = missing(x.channels, y.channels);
        for (const std::string& name : missing(integers_of(x), integers_of(y))) names.push_back(name + " in integers");
        return names;
    };
    const auto only_a = only_in(a.image, b.image), only_b = only_in(b.image, a.image);
    std::vector<std::string> common = names_of(a.image);
    std::erase_if(common, [&](const std::string& name) {
        return !missing({name}, names_of(b.image)).empty() ||
               a.image.integers.contains(name) != b.image.integers.contains(name);
    });
    if (!only_a.empty() || !only_b.empty())
        reasons.push_back(fmt::format(
            "channels differ: only the first has [{}], only the second [{}], both [{}]{}", fmt::join(only_a, " "),
            fmt::join(only_b, " "), fmt::join(common, " "),
            common.empty() ? ""
                           : fmt::format("; to compare those of both: --channels \"{}\"", fmt::join(common, ","))));
    return reasons;
}

bool matches(const std::string& name, const std::vector<std::string>& patterns) {
    return std::any_of(patterns.begin(), patterns.end(),
                       [&](const std::string& p) { return fnmatch(p.c_str(), name.c_str(), 0) == 0; });
}

/// The image's channels of floats `names`, in that order; it must have them.
Image select(const Image& image, const std::vector<std::string>& names) {
    Image selected(image.width, image.height, names);
    for (std::size_t c = 0; c < names.size(); ++c) {
        const auto from =
            std::size_t(std::find(image.channels.begin(), image.channels.end(), names[c]) - image.channels.begin());
        for (std::size_t i = 0; i < image.pixels(); ++i) selected.at(i, c) = image.at(i, from);
    }
    return selected;
}

/// Leaves the channels that match; returns why that makes no sense, or an empty string.
std::string keep_matching(LoadedImage& a, LoadedImage& b, const std::vector<std::string>& patterns) {
    std::vector<std::string> unused = patterns;
    for (LoadedImage* loaded : {&a, &b})
        std::erase_if(unused, [names = names_of(loaded->image)](const std::string& pattern) {
            return std::any_of(names.begin(), names.end(), [&](const auto& name) { return matches(name, {pattern}); });
        });
    if (!unused.empty())
        return fmt::format("no channel is called {}: the first has [{}], the second [{}]", fmt::join(unused, " or "),
                           fmt::join(names_of(a.image), " "), fmt::join(names_of(b.image), " "));
    for (LoadedImage* loaded : {&a, &b}) {
        std::vector<std::string> names = loaded->image.channels;
        std::erase_if(names, [&](const std::string& name) { return !matches(name, patterns); });
        auto integers = std::move(loaded->image.integers);
        std::erase_if(integers, [&](const auto& integer) { return !matches(integer.first, patterns); });
        loaded->image          = select(loaded->image, names);
        loaded->image.integers = std::move(integers);
    }
    return "";
}

/// Linear light as an 8- or 16-bit file would hold it. Alpha is not light.
void encode(Image& image) {
    const std::size_t n = image.channels.size();
    for (std::size_t c = 0; c < n; ++c) {
        if (image.channels[c] == "A" || image.channels[c].ends_with(".A")) continue;
        for (std::size_t i = 0; i < image.pixels(); ++i)
            image.at(i, c) = srgb_from_linear(std::clamp(image.at(i, c), 0.0f, 1.0f));
    }
}

Image one_channel(const Image& image, std::size_t c) { return select(image, {image.channels[c]}); }

/// The picture that is one of the image's layers.
Image layer_of(const Image& image, const Layer& layer) {
    Image picture(image.width, image.height, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (std::size_t c = 0; c < 3; ++c) picture.at(i, c) = image.at(i, layer.channels[c]);
    return picture;
}

/// The integers of both.
std::vector<IntegerDiff> integer_differences(const Image& a, const Image& b) {
    std::vector<IntegerDiff> found;
    for (const auto& [name, in_a] : a.integers) {
        const std::vector<std::uint32_t>& in_b = b.integers.at(name);
        IntegerDiff d{name};
        for (std::size_t i = in_a.size(); i-- > 0;)
            if (in_a[i] != in_b[i])
                d = {name,    d.differing + 1, int(i % std::size_t(a.width)), int(i / std::size_t(a.width)),
                     in_a[i], in_b[i]};
        found.push_back(d);
    }
    return found;
}

/// Where the largest difference is, or the first value that is not finite in one image only.
void find_worst(DiffResult& result, const Image& a, const Image& b) {
    auto& worst   = result.worst;
    const auto at = result.error.worst;
    worst         = {at.x, at.y, std::size_t(at.channel), 0, 0};
    std::size_t i = std::size_t(at.y) * std::size_t(a.width) + std::size_t(at.x);
    if (result.error.max == 0 && result.error.unlike_not_finite > 0) {
        const auto unlike = [&](std::size_t k) {
            return a.data[k] != b.data[k] && !(std::isnan(a.data[k]) && std::isnan(b.data[k]));
        };
        std::size_t k = 0;
        while (!unlike(k)) ++k;
        i     = k / a.channels.size();
        worst = {int(i % std::size_t(a.width)), int(i / std::size_t(a.width)), k % a.channels.size(), 0, 0};
    }
    worst.a = a.at(i, worst.channel), worst.b = b.at(i, worst.channel);
}

void measure(DiffResult& result, const Image& a, const Image& b, double fail) {
    result.width    = a.width;
    result.height   = a.height;
    result.channels = a.channels;
    result.error    = image_error(a, b, fail);
    for (std::size_t c = 0; c < a.channels.size(); ++c)
        result.channel_error.push_back(image_error(one_channel(a, c), one_channel(b, c), fail));
    result.integers = integer_differences(a, b);
    find_worst(result, a, b);
    result.flip.map.resize(a.pixels());
    const auto differs          = [&](std::size_t c) { return result.channel_error[c].differing > 0; };
    const std::vector<Layer> of = layers(a);
    std::vector<bool> shown(a.channels.size());
    bool any = false;
    for (const Layer& layer : of) {
        result.layers.push_back({layer.name.empty() ? "R G B" : layer.name});
        for (const std::size_t c : layer.channels) shown[c] = true;
        // Where there is nothing to see, FLIP takes its time over it.
        if (std::none_of(layer.channels.begin(), layer.channels.end(), differs)) continue;
        const Image in_a = layer_of(a, layer), in_b = layer_of(b, layer);
        Flip flip                 = result.hdr ? flip_hdr(in_a, in_b) : flip_ldr(in_a, in_b);
        result.layers.back().ssim = ssim(in_a, in_b);
        result.layers.back().flip = flip.mean;
        result.ssim               = std::min(result.ssim, result.layers.back().ssim);
        if (any && flip.mean <= result.flip.mean) continue;
        any                = true;
        result.worst_layer = result.layers.size() - 1;
        result.flip        = std::move(flip);
    }
    std::vector<std::string> unseen;
    for (std::size_t c = 0; c < a.channels.size(); ++c)
        if (!shown[c] && differs(c)) unseen.push_back(a.channels[c]);
    if (!unseen.empty())
        result.notes.push_back(fmt::format("SSIM and FLIP are of the layers of R, G, B; {} differ and are in neither",
                                           fmt::join(unseen, " ")));
}

/// Close or differs by the rules of a tolerance file.
void judge_by_rules(DiffResult& result, const Tolerance& tolerance, std::size_t rule, const ComparedImages& images) {
    result.rule_name = tolerance.images[rule].name;
    try {
        result.rules = rule_outcomes(tolerance, rule, images);
    } catch (const InputError& error) {
        result.reasons.emplace_back(error.what());
        result.verdict = Verdict::unreadable;
        return;
    }
    result.reasons = missed_rules(result.rules);
    result.verdict = result.rules.front().holds ? Verdict::close : Verdict::differs;
}

/// Close or differs; and why.
void judge(DiffResult& result, const DiffOptions& options, double fail, bool asks_fail) {
    const ImageError& e = result.error;
    const auto limit    = [&](bool missed, std::string reason) {
        if (missed) result.reasons.push_back(std::move(reason));
    };
    for (const IntegerDiff& d : result.integers)
        limit(d.differing > 0, fmt::format("whole numbers {} differ at {} pixels, the first ({}, {}): A {}, B {}",
                                           d.name, d.differing, d.x, d.y, d.a, d.b));
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

/// FLIP of the layer where it is largest, and B - A of every channel.
Image all_differences(const DiffResult& result, const Image& a, const Image& b) {
    const bool one = result.layers.size() == 1;
    std::vector<std::string> names{one ? "FLIP" : "FLIP." + result.layers.at(result.worst_layer).name};
    for (const std::string& name : a.channels) names.push_back("difference." + name);
    Image map(a.width, a.height, names);
    map.metadata = {{"umbra:difference", result.b + " minus " + result.a}};
    for (std::size_t i = 0; i < map.pixels(); ++i) {
        map.at(i, 0) = result.flip.map[i];
        for (std::size_t c = 0; c < a.channels.size(); ++c) map.at(i, c + 1) = b.at(i, c) - a.at(i, c);
    }
    return map;
}

void write_pictures(DiffResult& result, const Image& a, const Image& b, const DiffOptions& options) {
    const bool colours      = options.map.extension() == ".png" || !options.pictures.empty();
    const std::size_t layer = result.worst_layer;
    DifferenceMap map;
    if (colours) map = difference_map(a, b, result.hdr, layer), result.map_range = map.range;
    if (!options.map.empty())
        write_image(options.map, options.map.extension() == ".png" ? map.picture : all_differences(result, a, b));
    if (options.pictures.empty() || result.verdict == Verdict::same) return;
    const auto name = [&](const char* ending) { return options.pictures.string() + ending; };
    write_image(name(".a.png"), shown_picture(a, result.hdr, layer));
    write_image(name(".b.png"), shown_picture(b, result.hdr, layer));
    write_image(name(".map.png"), map.picture);
}

}  // namespace

std::string_view to_string(Verdict verdict) {
    constexpr std::array<std::string_view, kVerdicts.size()> kNames{"same", "close", "differs", "unlike", "unreadable"};
    return kNames[static_cast<std::size_t>(verdict)];
}

std::string accept_by_copying(const std::filesystem::path& a, const std::filesystem::path& b) {
    const std::filesystem::path folder = a.parent_path();
    return (folder.empty() || is_folder(folder) ? "" : "mkdir -p -- " + shell_quoted(folder.string()) + " && ") +
           fmt::format("cp -- {} {}", shell_quoted(b.string()), shell_quoted(a.string()));
}

DiffResult diff(const std::filesystem::path& file_a, const std::filesystem::path& file_b, const DiffOptions& options) {
    DiffResult result;
    result.name = options.name.empty() ? file_a.filename().string() : options.name;
    result.a    = file_a.string();
    result.b    = file_b.string();

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
        if (b.image.width > 0) result.accept = accept_by_copying(file_a, file_b);
        return result;
    }
    for (Image* image : {&a.image, &b.image})  // integers that are floats as well are compared as integers
        if (image->integers.contains(image->channels.front())) image->channels.clear(), image->data.clear();
    if (!options.channels.empty())
        if (std::string reason = keep_matching(a, b, options.channels); !reason.empty())
            result.reasons.push_back(std::move(reason));
    const bool is_chosen = result.reasons.empty();
    if (is_chosen) result.reasons = find_unlike(a, b);
    if (!result.reasons.empty()) {
        result.verdict = Verdict::unlike;
        if (is_chosen) result.accept = accept_by_copying(file_a, file_b);
        return result;
    }
    if (a.encoding != b.encoding) {
        const bool first = a.encoding == Encoding::linear;
        encode(first ? a.image : b.image);
        result.notes.push_back(
            fmt::format("{} holds linear light, the other sRGB: clamped and encoded before comparing",
                        first ? result.a : result.b));
    }
    auto integers    = std::move(b.image.integers);
    b.image          = select(b.image, a.image.channels);
    b.image.integers = std::move(integers);
    for (LoadedImage* loaded : {&a, &b}) spread_integers(loaded->image);
    result.hdr = a.encoding == Encoding::linear && b.encoding == Encoding::linear;

    const bool asks_else   = options.fail_rmse || options.fail_flip || options.fail_psnr || options.fail_ssim;
    const Tolerance* rules = options.tolerance.get();
    const std::size_t rule = rules ? rules->rule_of(result.name) : 0;
    const bool has_rule    = rules && rule < rules->images.size();
    const double fail =
        has_rule ? rules->first_limit(rule).value_or(kDefaultFail) : options.fail.value_or(kDefaultFail);
    measure(result, a.image, b.image, fail);
    std::size_t unlike = result.error.unlike_not_finite;
    for (const IntegerDiff& d : result.integers) unlike += d.differing;
    const bool is_same = unlike == 0 && result.error.max <= options.warn;
    if (!is_same && has_rule)
        judge_by_rules(result, *rules, rule,
                       {a.image, b.image, file_a, result.name, result.error.rmse, result.error.psnr, result.ssim,
                        result.flip.mean, unlike});
    else if (!is_same)
        judge(result, options, fail, options.fail || !asks_else);
    if (rules && !has_rule && !is_same)
        result.notes.push_back(fmt::format("no name in {} matches: no difference above {} is allowed",
                                           rules->file.string(), kDefaultFail));
    if (result.verdict == Verdict::differs) result.accept = accept_by_copying(file_a, file_b);
    write_pictures(result, a.image, b.image, options);
    return result;
}

}  // namespace umbra
