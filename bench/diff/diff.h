// Two image files, how far they differ, and whether that is little enough: the question behind `umbra diff`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"

namespace umbra {

/// The numbers are the exit codes.
enum class Verdict : std::uint8_t {
    same       = 0,  ///< all values equal, or none differs by more than `warn`
    close      = 1,  ///< not the same, but within every limit that was given
    differs    = 2,  ///< beyond a limit, or a value that is not finite in one image and another in the other
    unlike     = 3,  ///< not comparable: sizes, channels or data windows differ
    unreadable = 4
};
[[nodiscard]] std::string_view to_string(Verdict verdict);

/// Limits. Those that are not set are not asked; where none is, `fail` is kDefaultFail (rounding).
struct DiffOptions {
    std::optional<double> fail{};       ///< largest difference of a value
    double fail_percent = 0;            ///< this share of all pixels may be beyond `fail`
    std::optional<double> fail_rmse{};  ///< root mean square difference over all values
    std::optional<double> fail_flip{};  ///< mean FLIP
    std::optional<double> fail_psnr{};  ///< dB against a peak of 1; less is too little
    std::optional<double> fail_ssim{};  ///< less is too little
    double warn = 0;                    ///< largest difference of a value that still counts as the same
    std::filesystem::path map{};        ///< .png: FLIP of each pixel in grey; .exr: FLIP, and B - A of every channel
};
inline constexpr double kDefaultFail = 1e-6;

struct DiffResult {
    Verdict verdict = Verdict::same;
    std::string a, b;                  ///< file names
    std::vector<std::string> reasons;  ///< which limits were missed; what is unlike; why a file is unreadable
    std::vector<std::string> notes;    ///< what was assumed

    // Only where the images are comparable:
    int width = 0, height = 0;
    std::vector<std::string> channels;      ///< of A; B has the same, perhaps in another order
    std::vector<ImageError> channel_error;  ///< one a channel
    ImageError error;                       ///< over all of them; `over` counts pixels beyond `fail`
    double ssim = 1;                        ///< of R, G, B's luminance, or of the first channel, values as stored
    Flip flip;                              ///< of R, G, B, or of the first channel
    bool hdr = false;                       ///< HDR-FLIP: both files hold linear light; LDR-FLIP otherwise

    [[nodiscard]] bool comparable() const { return verdict <= Verdict::differs; }
};

/// Compares value by value as the files store them (integer formats scaled to [0, 1]), channels by name. Where one file
/// holds sRGB and the other linear light, the linear one is clamped and encoded first, and a note says so. Never throws
/// for what is wrong with the files; throws InputError where the map cannot be written.
[[nodiscard]] DiffResult diff(const std::filesystem::path& a, const std::filesystem::path& b,
                              const DiffOptions& options);

/// For people, ends in a newline. Nothing but the verdict and its reasons where the images are not comparable.
[[nodiscard]] std::string diff_text(const DiffResult& result);

/// verdict, mae, rmse, max, psnr (null where equal), ssim, flip {...}, worst {x, y, channel}, ... File names may hold
/// any bytes: dump with error_handler_t::replace.
[[nodiscard]] nlohmann::json diff_json(const DiffResult& result);

}  // namespace umbra
