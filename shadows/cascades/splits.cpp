#include "umbra/shadows/cascades/splits.h"

#include <cmath>

namespace umbra {

std::vector<double> split_depths(Splits splits, double lambda, double near, double far, int m) {
    std::vector<double> depths{near};
    for (int i = 1; i < m; ++i) {
        const double part        = static_cast<double>(i) / m;
        const double uniform     = near + (far - near) * part;
        const double logarithmic = near * std::pow(far / near, part);
        depths.push_back(splits == Splits::uniform       ? uniform
                         : splits == Splits::logarithmic ? logarithmic
                                                         : lambda * logarithmic + (1 - lambda) * uniform);
    }
    depths.push_back(far);
    return depths;
}

}  // namespace umbra
