// Two image files: how far they differ, and whether that is within given limits. Behind `umbra diff`.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/gate/tolerance.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"

namespace umbra {

/// The numbers are the exit codes.
enum class Verdict : std::uint8_t {
    same       = 0,  ///< all values equal, or none differs by more than `warn`
    close      = 1,  ///< not the same, but within every limit that was given
    differs    = 2,  ///< beyond a limit, or a value that is not finite in one image and another in the other
    unlike     = 3,  ///< not comparable: sizes, channels, windows or what the files say about colours differ
    unreadable = 4
};
inline constexpr std::array kVerdicts = {Verdict::same, Verdict::close, Verdict::differs, Verdict::unlike,
                                         Verdict::unreadable};
[[nodiscard]] std::string_view to_string(Verdict verdict);

/// Limits. Those that are not set are not asked; where none is, `fail` is kDefaultFail (rounding).
struct DiffOptions {
    std::optional<double> fail{};       ///< largest difference of a value
    double fail_percent = 0;            ///< this share of all pixels may be beyond `fail`
    std::optional<double> fail_rmse{};  ///< root mean square difference over all values
    std::optional<double> fail_flip{};  ///< mean FLIP of any layer
    std::optional<double> fail_psnr{};  ///< dB against a peak of 1; less is too little
    std::optional<double> fail_ssim{};  ///< of any layer; less is too little
    double warn = 0;                    ///< largest difference of a value that still counts as the same
    /// Instead of the limits above, except `warn`; an image without a rule in it is judged by kDefaultFail.
    std::shared_ptr<const Tolerance> tolerance{};
    std::string name{};  ///< DiffResult::name; empty: A's file name
    /// Compare only channels of these names, shell patterns allowed ("S.*"); empty: all.
    std::vector<std::string> channels{};
    /// .png: difference_map (bench/gate/difference_map.h); .exr: FLIP, and B - A of every channel. Empty: none.
    std::filesystem::path map{};
    /// Where the images are comparable and not the same: writes PICTURES.a.png, .b.png and .map.png. Empty: none.
    std::filesystem::path pictures{};
};
inline constexpr double kDefaultFail = 1e-6;

/// What the pictures of an image (layers() of core/image/image.h) differ by.
struct LayerDiff {
    std::string name;  ///< "R G B" of that without a name
    double ssim = 1;   ///< of the luminance, values as stored
    double flip = 0;   ///< mean
};

/// A channel of whole numbers: names of things, which no distance is between.
struct IntegerDiff {
    std::string name;
    std::size_t differing = 0;  ///< pixels
    int x = 0, y = 0;           ///< the first of them
    std::uint32_t a = 0, b = 0;
};

struct DiffResult {
    Verdict verdict = Verdict::same;
    std::string name;                  ///< of the pair: the file's path inside its folder, or A's file name
    std::string a, b;                  ///< file names
    std::vector<std::string> reasons;  ///< which limits were missed; what is unlike; why a file is unreadable
    std::vector<std::string> notes;    ///< what was assumed
    std::string accept;  ///< a command of sh that makes A what B is; empty where there is nothing to accept
    /// Of the tolerance file, where the images are comparable and not the same: the pattern, and what its rules say.
    std::string rule_name;
    std::vector<RuleOutcome> rules;

    // Only where the images are comparable:
    int width = 0, height = 0;
    std::vector<std::string> channels;      ///< of A; B has the same, perhaps in another order
    std::vector<ImageError> channel_error;  ///< one a channel
    ImageError error;                       ///< over all of them; `over` counts pixels beyond `fail`
    std::vector<IntegerDiff> integers;      ///< in no other figure; no limit allows one that differs
    std::vector<LayerDiff> layers;          ///< all pictures
    double ssim = 1;                        ///< smallest of the layers
    Flip flip;                              ///< of the layer whose mean is largest
    std::size_t worst_layer = 0;            ///< that one
    bool hdr                = false;        ///< HDR-FLIP: both files hold linear light; LDR-FLIP otherwise
    struct {
        int x = 0, y = 0;
        std::size_t channel = 0;  ///< index into `channels`
        float a = 0, b = 0;       ///< the values of the two images there
    } worst;               ///< largest difference; where there is none, the first unlike value that is not finite
    double map_range = 0;  ///< of the difference map, if written: its darkest colours are +-this

    [[nodiscard]] bool comparable() const { return width > 0; }
    [[nodiscard]] bool any_difference() const {
        return error.differing > 0 ||
               std::any_of(integers.begin(), integers.end(), [](const IntegerDiff& d) { return d.differing > 0; });
    }
};

/// A command that puts B in A's place: mkdir, where A's folder is missing, and cp.
[[nodiscard]] std::string accept_by_copying(const std::filesystem::path& a, const std::filesystem::path& b);

/// Compares all parts and channels value by value as the files store them (integer formats scaled to [0, 1]), channels
/// by name. Where one file holds sRGB and the other linear light, the linear one is clamped and encoded first, and a
/// note says so. Never throws for what is wrong with the files; throws InputError where the map cannot be written.
[[nodiscard]] DiffResult diff(const std::filesystem::path& a, const std::filesystem::path& b,
                              const DiffOptions& options);

}  // namespace umbra
