#include "umbra/bench/gate/tolerance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/record.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

constexpr double kBandWidth = 1.5, kBandStep = 0.1;
constexpr std::size_t kDeepest = 32;  ///< of rules in rules

/// Before rules are read, which takes stack.
void check_depth(const Field& field, std::size_t depth) {
    if (depth > kDeepest) field.refuse(fmt::format("at most {} rules inside one another", kDeepest));
    if (!field.is_object()) return;  // refused when it is read
    for (const char* key : {"all", "any"})
        for (const Field& rule : field[key].items()) check_depth(rule, depth + 1);
}

/// Checks that each rule is one of its kinds, and the pairs of histograms.
void check_rule(const Field& field, const ToleranceRule& rule) {
    constexpr std::string_view kOne =
        "an object with exactly one of all, any, pixels, flip, rmse, psnr, ssim, histogram, and something in it";
    if (int(!rule.all.empty()) + int(!rule.any.empty()) + int(rule.pixels.has_value()) + int(rule.flip.has_value()) +
            int(rule.rmse.has_value()) + int(rule.psnr.has_value()) + int(rule.ssim.has_value()) +
            int(!rule.histogram.empty()) !=
        1)
        field.refuse(kOne);
    for (const auto& [key, rules] : {std::pair{"all", &rule.all}, std::pair{"any", &rule.any}}) {
        const std::vector<Field> items = field[key].items();
        for (std::size_t i = 0; i < items.size(); ++i) check_rule(items[i], (*rules)[i]);
    }
    for (const Field& step : field["histogram"].items()) {
        const std::vector<Field> pair = step.items();
        if (pair.size() != 2 || pair[0].number().value_or(-1) < 0 || pair[1].number().value_or(-1) < 0 ||
            *pair[1].number() > 100)
            step.refuse("[LIMIT, PERCENT]: a number from 0 on, and one from 0 to 100");
    }
}

/// The picture that a rule names.
Image picture_of(const FileName& named, const Tolerance& tolerance, const ComparedImages& images) {
    std::string name = named.name;
    if (const std::size_t at = name.find("{}"); at != std::string::npos)
        name.replace(at, 2, fs::path(images.name).replace_extension().string());
    const fs::path file = tolerance.file.parent_path() / name;
    Image picture       = read_image(file).image;
    if (picture.width != images.a.width || picture.height != images.a.height)
        throw InputError(fmt::format("{}: found {}x{} pixels, expected {}x{} as {} has", file.string(), picture.width,
                                     picture.height, images.a.width, images.a.height, images.file_a.string()));
    return picture;
}

using Pixels = std::vector<std::uint8_t>;  ///< 1 or 0, one a pixel

Pixels mask_pixels(const FileName& mask, const Tolerance& tolerance, const ComparedImages& images) {
    const Image picture = picture_of(mask, tolerance, images);
    const auto colours  = colour_channels(picture);
    Pixels masked(picture.pixels());
    for (std::size_t i = 0; i < masked.size(); ++i)
        masked[i] =
            std::any_of(colours.begin(), colours.end(), [&](std::size_t c) { return picture.at(i, c) > 0; }) ? 1 : 0;
    return masked;
}

Pixels edge_pixels(const EdgeBandRule& rule, const Tolerance& tolerance, const ComparedImages& images) {
    const Image plane = rule.plane ? picture_of(rule.plane, tolerance, images) : read_image(images.file_a).image;
    std::vector<std::size_t> of;
    const std::string pattern = rule.channel.empty() ? "S.*" : rule.channel;
    for (std::size_t c = 0; c < plane.channels.size(); ++c)
        if (fnmatch(pattern.c_str(), plane.channels[c].c_str(), 0) == 0) of.push_back(c);
    if (of.empty() && rule.channel.empty() && rule.plane)
        for (std::size_t c = 0; c < plane.channels.size(); ++c) of.push_back(c);
    if (of.empty())
        throw InputError(fmt::format("{}: found channels {}, expected one that matches {}, for the edge band",
                                     rule.plane ? rule.plane.name : images.file_a.string(),
                                     fmt::join(plane.channels, " "), pattern));
    const double width = std::isnan(rule.width) ? kBandWidth : rule.width;
    const double step  = std::isnan(rule.step) ? kBandStep : rule.step;
    Pixels band(plane.pixels());
    const auto near = [&](double x, double y) {  // the pixels whose centre is within the width of a point
        for (int v = std::max(0, int(std::ceil(y - width))); v <= std::min(plane.height - 1, int(y + width)); ++v)
            for (int u = std::max(0, int(std::ceil(x - width))); u <= std::min(plane.width - 1, int(x + width)); ++u)
                if (std::hypot(u - x, v - y) <= width)
                    band[std::size_t(v) * std::size_t(plane.width) + std::size_t(u)] = 1;
    };
    const auto differ = [&](std::size_t i, std::size_t j) {  // false where one is NaN
        return std::any_of(of.begin(), of.end(),
                           [&](std::size_t c) { return std::abs(plane.at(i, c) - plane.at(j, c)) > step; });
    };
    for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(plane.width) + std::size_t(x);
            if (x + 1 < plane.width && differ(i, i + 1)) near(x + 0.5, y);
            if (y + 1 < plane.height && differ(i, i + std::size_t(plane.width))) near(x, y + 0.5);
        }
    return band;
}

/// How far pixel i of one image is from pixel j of the other: the largest difference of a value; infinite where one is
/// finite and the other is not, or whole numbers differ.
double distance(const Image& p, std::size_t i, const Image& q, std::size_t j) {
    double most = 0;
    for (std::size_t c = 0; c < p.channels.size(); ++c) {
        const double a = p.at(i, c), b = q.at(j, c);
        if (a == b || (std::isnan(a) && std::isnan(b))) continue;
        if (!std::isfinite(a) || !std::isfinite(b)) return kInfinity;
        most = std::max(most, std::abs(a - b));
    }
    for (const auto& [name, in_p] : p.integers)
        if (in_p[i] != q.integers.at(name)[j]) return kInfinity;
    return most;
}

/// Whether q has a pixel within the limit of p's pixel i, at most `shift` pixels away in x and in y.
bool has_near(const Image& p, std::size_t i, const Image& q, int shift, double limit) {
    const int x = int(i % std::size_t(p.width)), y = int(i / std::size_t(p.width));
    for (int v = std::max(0, y - shift); v <= std::min(p.height - 1, y + shift); ++v)
        for (int u = std::max(0, x - shift); u <= std::min(p.width - 1, x + shift); ++u)
            if (distance(p, i, q, std::size_t(v) * std::size_t(p.width) + std::size_t(u)) <= limit) return true;
    return false;
}

/// Asks the rules of one pair of images.
class RuleAsker {
public:
    RuleAsker(const Tolerance& tolerance, const ComparedImages& images) : tolerance_(tolerance), images_(images) {}

    bool ask(const ToleranceRule& rule, const std::string& at, std::size_t depth) {
        if (!rule.all.empty()) return group("all", rule.all, at, depth);
        if (!rule.any.empty()) return group("any", rule.any, at, depth);
        if (rule.pixels) return pixels(*rule.pixels, at + "/pixels", depth);
        if (!rule.histogram.empty()) return histogram(rule.histogram, at + "/histogram", depth);
        const ComparedImages& of = images_;
        if (rule.flip) return pooled("flip", "mean FLIP", of.flip, *rule.flip, of.flip <= *rule.flip, at, depth);
        if (rule.rmse) return pooled("rmse", "RMSE", of.rmse, *rule.rmse, of.rmse <= *rule.rmse, at, depth);
        if (rule.psnr) return pooled("psnr", "PSNR", of.psnr, *rule.psnr, of.psnr >= *rule.psnr, at, depth);
        return pooled("ssim", "SSIM", of.ssim, *rule.ssim, of.ssim >= *rule.ssim, at, depth);
    }
    [[nodiscard]] std::vector<RuleOutcome> outcomes() && { return std::move(outcomes_); }

private:
    /// Makes room for a rule, which stands before its parts.
    std::size_t begin(std::string rule, std::string at, std::size_t depth) {
        outcomes_.push_back({.at = std::move(at), .rule = std::move(rule), .depth = depth});
        return outcomes_.size() - 1;
    }
    bool end(std::size_t index, bool holds, std::string says) {
        outcomes_[index].holds = holds;
        outcomes_[index].says  = std::move(says);
        return holds;
    }

    bool group(const char* kind, const std::vector<ToleranceRule>& rules, const std::string& at, std::size_t depth) {
        const std::size_t index = begin(kind, fmt::format("{}/{}", at, kind), depth);
        std::size_t hold        = 0;
        for (std::size_t i = 0; i < rules.size(); ++i)
            hold += ask(rules[i], fmt::format("{}/{}/{}", at, kind, i), depth + 1) ? 1 : 0;
        return end(index, std::string_view(kind) == "all" ? hold == rules.size() : hold > 0,
                   fmt::format("{} of {} hold", hold, rules.size()));
    }

    bool pooled(const char* kind, const char* called, double figure, double limit, bool holds, const std::string& at,
                std::size_t depth) {
        const std::size_t index = begin(kind, fmt::format("{}/{}", at, kind), depth);
        const bool is_least     = std::string_view(kind) == "psnr" || std::string_view(kind) == "ssim";
        std::string says =
            fmt::format("{} {:.4g} (allowed: {} {})", called, figure, is_least ? "at least" : "up to", limit);
        if (images_.unlike > 0)
            says += fmt::format("; {} values are finite in one image alone or are other whole numbers", images_.unlike);
        outcomes_[index].figure = figure;
        outcomes_[index].limit  = limit;
        return end(index, holds && images_.unlike == 0, std::move(says));
    }

    /// Pixels beyond, of which `never` are beyond every limit, as a percentage that holds or does not.
    bool percentage(std::size_t index, std::size_t beyond, std::size_t never, double limit, double percent,
                    const std::string& more) {
        const double found      = 100 * double(beyond) / double(images_.a.pixels());
        outcomes_[index].figure = found;
        outcomes_[index].limit  = percent;
        std::string says =
            fmt::format("{} pixels ({:.4g} %) differ by more than {} (allowed: {} %)", beyond, found, limit, percent);
        if (never > 0)
            says += fmt::format(
                "; {} of them in a value that is not finite or a whole number, which no percentage covers", never);
        return end(index, found <= percent && never == 0, says + more);
    }

    bool pixels(const PixelRule& rule, const std::string& at, std::size_t depth) {
        const std::size_t index = begin("pixels", at, depth);
        const Image &a = images_.a, &b = images_.b;
        const Pixels masked = rule.mask ? mask_pixels(rule.mask, tolerance_, images_) : Pixels(a.pixels());
        const Pixels band   = rule.edge_band ? edge_pixels(*rule.edge_band, tolerance_, images_) : Pixels(a.pixels());
        Conceded conceded;
        std::size_t beyond = 0, never = 0;
        for (std::size_t i = 0; i < a.pixels(); ++i) {
            const double apart = distance(a, i, b, i);
            if (apart <= rule.limit) continue;
            const bool by_shift = rule.shift > 0 && has_near(a, i, b, int(rule.shift), rule.limit) &&
                                  has_near(b, i, a, int(rule.shift), rule.limit);
            const int ways = int(by_shift) + int(band[i]) + int(masked[i]);
            if (ways > 1) ++conceded.several;
            if (ways == 1) ++(by_shift ? conceded.shift : band[i] ? conceded.edge_band : conceded.mask);
            if (ways > 0) continue;
            ++beyond;
            if (std::isinf(apart)) ++never;
        }
        const std::string more    = concessions(conceded);
        outcomes_[index].conceded = conceded;
        return percentage(index, beyond, never, rule.limit, std::isnan(rule.percent) ? 0 : rule.percent,
                          more.empty() ? "" : "; " + more);
    }

    bool histogram(const std::vector<std::vector<double>>& steps, const std::string& at, std::size_t depth) {
        const std::size_t index = begin("histogram", at, depth);
        const Image &a = images_.a, &b = images_.b;
        std::vector<std::size_t> beyond(steps.size());
        std::size_t never = 0, hold = 0;
        for (std::size_t i = 0; i < a.pixels(); ++i) {
            const double apart = distance(a, i, b, i);
            if (std::isinf(apart)) ++never;
            for (std::size_t k = 0; k < steps.size(); ++k) beyond[k] += apart > steps[k][0] ? 1 : 0;
        }
        for (std::size_t k = 0; k < steps.size(); ++k)
            hold += percentage(begin("step", fmt::format("{}/{}", at, k), depth + 1), beyond[k], never, steps[k][0],
                               steps[k][1], "")
                        ? 1
                        : 0;
        return end(index, hold == steps.size(), fmt::format("{} of {} steps hold", hold, steps.size()));
    }

    const Tolerance& tolerance_;
    const ComparedImages& images_;
    std::vector<RuleOutcome> outcomes_;
};

}  // namespace

std::size_t Tolerance::rule_of(const std::string& name) const {
    std::size_t i = 0;
    while (i < images.size() && fnmatch(images[i].name.c_str(), name.c_str(), 0) != 0) ++i;
    return i;
}

std::optional<double> Tolerance::first_limit(std::size_t index) const {
    const auto search = [](const ToleranceRule& rule, const auto& again) -> std::optional<double> {
        if (rule.pixels) return rule.pixels->limit;
        for (const auto* rules : {&rule.all, &rule.any})
            for (const ToleranceRule& part : *rules)
                if (const auto limit = again(part, again)) return limit;
        return std::nullopt;
    };
    return search(images.at(index).passes, search);
}

Tolerance read_tolerance(const fs::path& file) {
    if (!is_file(file)) throw InputError(fmt::format("{}: cannot be opened, expected a tolerance file", file.string()));
    const Field root  = parse_json(bytes_of(file), file.string());
    const auto images = root["images"].items();
    for (const Field& image : images)
        if (image.is_object()) check_depth(image["passes"], 0);
    Tolerance tolerance = from_strict_record<Tolerance>(root);
    tolerance.file      = file;
    if (images.empty()) root["images"].refuse("a list of rules with names of images");
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (!images[i]["passes"].present()) images[i]["passes"].refuse("a rule");
        check_rule(images[i]["passes"], tolerance.images[i].passes);
    }
    return tolerance;
}

std::vector<RuleOutcome> rule_outcomes(const Tolerance& tolerance, std::size_t index, const ComparedImages& images) {
    RuleAsker asker(tolerance, images);
    asker.ask(tolerance.images.at(index).passes, fmt::format("/images/{}/passes", index), 0);
    return std::move(asker).outcomes();
}

std::vector<std::string> missed_rules(const std::vector<RuleOutcome>& outcomes) {
    std::vector<std::string> missed;
    for (std::size_t i = 0; i < outcomes.size();) {
        const RuleOutcome& of = outcomes[i++];
        const bool is_leaf    = i == outcomes.size() || outcomes[i].depth <= of.depth;
        if (of.holds)  // whatever it consists of
            while (i < outcomes.size() && outcomes[i].depth > of.depth) ++i;
        else if (is_leaf)
            missed.push_back(of.says);
    }
    return missed;
}

std::string needed_concessions(const std::vector<RuleOutcome>& outcomes) {
    struct Needed {
        std::size_t pixels = 0;
        std::vector<std::string> says{};
    };
    std::size_t at    = 0;
    const auto needed = [&](const auto& again) -> Needed {  // of the rule at `at`, which it passes with its parts
        const RuleOutcome& rule = outcomes[at++];
        const bool is_any       = rule.rule == "any";
        Needed sum;
        if (rule.conceded && rule.conceded->sum() > 0) sum = {rule.conceded->sum(), {concessions(*rule.conceded)}};
        bool is_first = true;
        while (at < outcomes.size() && outcomes[at].depth > rule.depth) {
            const bool holds = outcomes[at].holds;
            Needed part      = again(again);
            if (!is_any) {
                sum.pixels += part.pixels;
                sum.says.insert(sum.says.end(), part.says.begin(), part.says.end());
            } else if (holds && (is_first || part.pixels < sum.pixels)) {
                sum      = std::move(part);
                is_first = false;
            }
        }
        return sum;
    };
    if (outcomes.empty() || !outcomes.front().holds) return "";
    return fmt::format("{}", fmt::join(needed(needed).says, "; "));
}

std::string concessions(const Conceded& conceded) {
    std::vector<std::string> each;
    const auto add = [&](std::size_t pixels, const char* by) {
        if (pixels > 0) each.push_back(fmt::format("{} pixel{} {}", pixels, pixels == 1 ? " passes" : "s pass", by));
    };
    add(conceded.shift, "only by the shift");
    add(conceded.edge_band, "only by the edge band");
    add(conceded.mask, "only by the mask");
    add(conceded.several, "by more than one of shift, edge band and mask");
    return fmt::format("{}", fmt::join(each, ", "));
}

}  // namespace umbra
