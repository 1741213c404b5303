// What `umbra diff` prints about one pair of images.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "umbra/bench/gate/diff.h"

namespace umbra {

/// For people, several lines, ends in a newline. Only the verdict and its reasons where the images are not comparable.
[[nodiscard]] std::string diff_text(const DiffResult& result);

/// The same in one line without its end: verdict, name, reasons, worst pixel.
[[nodiscard]] std::string diff_line(const DiffResult& result);

/// "(5, 17), channel G: A 0.1, B 0.6"; empty where the images do not differ or are not comparable.
[[nodiscard]] std::string worst_pixel(const DiffResult& result);

/// "spec, worst of 2 layers": what SSIM and FLIP are of; empty where there is one layer.
[[nodiscard]] std::string layer_of_flip(const DiffResult& result);

/// Names of the channels, those of whole numbers last.
[[nodiscard]] std::vector<std::string> all_channels(const DiffResult& result);

/// verdict, mae, rmse, max, psnr (null where equal), ssim, flip {...}, worst {x, y, channel, a, b}, ... Values that are
/// not finite become null. File names may hold any bytes: dump with error_handler_t::replace.
[[nodiscard]] nlohmann::json diff_json(const DiffResult& result);

}  // namespace umbra
