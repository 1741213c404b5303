// Where the view is split: the depths at which one cascade ends and the next begins.
//
// This work is based on:
// Fan Zhang, Hanqiu Sun, Leilei Xu, Lee Kit Lun. Parallel-Split Shadow Maps for Large-Scale Virtual Environments. 2006
// Brandon Lloyd, David Tuft, Sung-eui Yoon, Dinesh Manocha. Warping and Partitioning for Low Error Shadow Maps. 2006
#pragma once

#include <cstdint>
#include <vector>

namespace umbra {

enum class Splits : std::uint8_t {
    uniform,      ///< n + (f - n) i / m
    logarithmic,  ///< n (f / n)^(i / m): from the first to the last depth of a part pixels grow by (f / n)^(1 / m)
    practical     ///< lambda times the logarithmic one and 1 - lambda times the uniform one
};

/// The m + 1 depths from `near` to `far`, ascending, the two ends as they are: depths i and i + 1 bound part i.
/// 0 < near <= far, m >= 1; `lambda` is in [0, 1] and of use to `practical` alone.
[[nodiscard]] std::vector<double> split_depths(Splits splits, double lambda, double near, double far, int m);

}  // namespace umbra
