// Rules for when a changed picture still passes, read from a file. Behind `umbra diff --tolerance`; docs/gate.md
// describes the file.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/core/image/image.h"

namespace umbra {

/// Pixels near a shadow boundary of an S_j plane.
struct EdgeBandRule {
    FileName plane{};       ///< a picture; "{}" is the compared picture's name without its ending; none: A itself
    std::string channel{};  ///< shell pattern; empty: "S.*", and of a plane without such channels all
    double width = kUnknown, step = kUnknown;
};
DESCRIBE(EdgeBandRule) {
    of.name("edge_band", "pixels near a shadow boundary of an S_j plane");
    of.may(MEMBER(plane));
    of.may(MEMBER(channel));
    of.may(MEMBER(width), "px from the boundary; 1.5", Allowed{.least = 0, .most = 64});
    of.may(MEMBER(step), "a boundary passes where S changes by more from pixel to pixel; 0.1",
           Allowed{.least = 0, .most = 1});
}

struct PixelRule {
    double limit = kUnknown, percent = kUnknown;
    std::uint32_t shift = 0;
    std::optional<EdgeBandRule> edge_band{};
    FileName mask{};
};
DESCRIBE(PixelRule) {
    of.name("pixels", "each pixel by itself");
    of.must(MEMBER(limit), "largest difference of a value", at_least(0));
    of.may(MEMBER(percent), "of all pixels that may be beyond; 0", Allowed{.least = 0, .most = 100});
    of.may(MEMBER(shift), "px within which the other picture has a pixel within the limit",
           Allowed{.least = 0, .most = 16});
    of.may(MEMBER(edge_band), "not compared");
    of.may(MEMBER(mask), "a picture: what is not black is not compared");
}

/// Exactly one member holds something.
struct ToleranceRule {
    std::vector<ToleranceRule> all{}, any{};
    std::optional<PixelRule> pixels{};
    std::optional<double> flip{}, rmse{}, psnr{}, ssim{};
    std::vector<std::vector<double>> histogram{};  ///< {limit, percent}
};
DESCRIBE(ToleranceRule) {
    of.name("rule");
    of.may(MEMBER(all), "every one of these holds");
    of.may(MEMBER(any), "at least one of these holds");
    of.may(MEMBER(pixels));
    of.may(MEMBER(flip), "largest mean FLIP of any layer", kFraction);
    of.may(MEMBER(rmse), "largest root mean square difference", at_least(0));
    of.may(MEMBER(psnr), "smallest PSNR, dB");
    of.may(MEMBER(ssim), "smallest SSIM of any layer", Allowed{.least = -1, .most = 1});
    of.may(MEMBER(histogram), "[limit, percent]: at most so many pixels differ by more");
}

struct NamedRule {
    std::string name{};
    ToleranceRule passes{};
};
DESCRIBE(NamedRule) {
    of.name("image");
    of.must(MEMBER(name), "shell pattern of names; * is any text, / included");
    MEMBERS(passes);
}

struct Tolerance {
    std::vector<NamedRule> images{};
    std::filesystem::path file{};

    /// Index of the first whose name matches; images.size() where none does.
    [[nodiscard]] std::size_t rule_of(const std::string& name) const;
    /// The limit of the first rule about pixels of images[index], for figures; nothing where it has none.
    [[nodiscard]] std::optional<double> first_limit(std::size_t index) const;
};
DESCRIBE(Tolerance) {
    of.name("tolerance");
    of(MEMBER(images), "the first whose name matches counts");
}

/// Throws InputError with file, position, what was found and what was expected.
[[nodiscard]] Tolerance read_tolerance(const std::filesystem::path& file);

/// How many pixels beyond a limit passed all the same, and why. A pixel is in one of them.
struct Conceded {
    std::size_t shift = 0, edge_band = 0, mask = 0;  ///< through this alone
    std::size_t several = 0;                         ///< through more than one of them

    [[nodiscard]] std::size_t sum() const { return shift + edge_band + mask + several; }
};
DESCRIBE(Conceded) {
    of.name("conceded", "pixels beyond the limit that passed all the same");
    of(MEMBER(shift), "only because a pixel of the other picture is near");
    of(MEMBER(edge_band), "only because a shadow boundary is near");
    of(MEMBER(mask), "only because of the mask");
    of(MEMBER(several), "because of more than one of these");
}

/// One rule of the tree and whether it holds.
struct RuleOutcome {
    std::string at{};    ///< its position in the file, a JSON pointer
    std::string rule{};  ///< "all", "any", "pixels", "flip", ..., "step" of a histogram
    bool holds    = false;
    double figure = kUnknown, limit = kUnknown;  ///< of leaves; of pixels and steps: percent of the pixels
    std::optional<Conceded> conceded{};          ///< of pixels
    std::string says{};
    std::size_t depth = 0;  ///< in the tree: 0 is the root
};
DESCRIBE(RuleOutcome) {
    of.name("rule_outcome");
    MEMBERS(at, rule, holds);
    of.may(MEMBER(figure));
    of.may(MEMBER(limit));
    of.may(MEMBER(conceded));
    MEMBERS(says);
}

/// Two pictures of one size, and their figures.
struct ComparedImages {
    const Image& a;  ///< values and whole numbers; the channels of both are the same, in the same order
    const Image& b;
    std::filesystem::path file_a;
    std::string name;
    double rmse = 0, psnr = 0, ssim = 1, flip = 0;
    std::size_t unlike = 0;  ///< values that are finite in one image alone, and whole numbers that differ
};

/// The rule images[index] and those below it, each before those that it consists of. A value that is finite in one
/// image alone, or a whole number that differs, is beyond every limit, and no percentage covers it. Throws InputError
/// where a mask or a plane cannot be read or does not fit.
[[nodiscard]] std::vector<RuleOutcome> rule_outcomes(const Tolerance& tolerance, std::size_t index,
                                                     const ComparedImages& images);

/// The sentences of the leaves that keep the root from holding; empty where it holds.
[[nodiscard]] std::vector<std::string> missed_rules(const std::vector<RuleOutcome>& outcomes);

/// "12 pixels pass only by the mask": each such count; empty where there is none.
[[nodiscard]] std::string concessions(const Conceded& conceded);

/// The same of all rules that the root needs to hold: of an `any`, the one that concedes the fewest pixels. Empty where
/// the root does not hold.
[[nodiscard]] std::string needed_concessions(const std::vector<RuleOutcome>& outcomes);

}  // namespace umbra
