#include "umbra/tests/support/unbiased.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <string>

#include "umbra/tests/support/asked.h"

namespace umbra {
namespace {

constexpr float kFewest            = 1.0f / 32;  // of the light
constexpr int kLevels              = 4;
constexpr std::size_t kGroupPoints = 64;

using Group = std::vector<std::size_t>;

/// Points of like S_j, neighbours in the batch's order; a last group that would be small joins the one before it.
std::vector<Group> groups_of(const VisibilityPlane& expected) {
    std::vector<Group> groups;
    for (int level = 0; level < kLevels; ++level) {
        const std::size_t first = groups.size();
        for (std::size_t i = 0; i < expected.s.size(); ++i) {
            const float s = expected.s[i];
            if (expected.answer[i] != Answer::given || s < kFewest || s > 1 - kFewest) continue;
            if (static_cast<int>(s * kLevels) != level) continue;
            if (groups.size() == first || groups.back().size() == kGroupPoints) groups.emplace_back();
            groups.back().push_back(i);
        }
        if (groups.size() > first + 1 && groups.back().size() < kGroupPoints / 2) {
            const Group rest = std::move(groups.back());
            groups.pop_back();
            groups.back().insert(groups.back().end(), rest.begin(), rest.end());
        }
    }
    return groups;
}

template <class Value>
double mean_over(const Group& group, const Value& value) {
    double sum = 0;
    for (const std::size_t i : group) sum += static_cast<double>(value(i));
    return sum / static_cast<double>(group.size());
}

}  // namespace

BiasTest bias_test(const VisibilityPlane& expected, int seeds, const std::function<VisibilityPlane(int seed)>& sample) {
    const std::vector<Group> groups = groups_of(expected);
    BiasTest test{.groups = static_cast<int>(groups.size())};
    if (groups.empty()) return test;

    std::vector<std::vector<double>> residuals(groups.size());  // [group][seed]
    for (int k = 0; k < seeds; ++k) {
        const VisibilityPlane plane = sample(k + 1);
        for (std::size_t g = 0; g < groups.size(); ++g)
            residuals[g].push_back(mean_over(groups[g], [&](std::size_t i) {
                return static_cast<double>(plane.s[i]) - static_cast<double>(expected.s[i]);
            }));
    }

    const boost::math::students_t distribution(seeds - 1);
    std::vector<double> errors;
    double worst = 2;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        double mean = 0, squares = 0;
        for (const double r : residuals[g]) mean += r / seeds;
        for (const double r : residuals[g]) squares += (r - mean) * (r - mean);
        const double error = std::sqrt(squares / (seeds - 1) / seeds);
        const double doubt = mean_over(groups[g], [&](std::size_t i) { return expected.half_width[i]; });
        const double off   = std::max(0.0, std::abs(mean) - doubt);
        errors.push_back(error);
        // Equal runs, whatever the seed, and yet not as expected: no chance can explain that.
        const double p = off == 0 ? 1 : error == 0 ? 0 : 2 * cdf(complement(distribution, off / error));
        if (p >= worst) continue;
        worst         = p;
        test.bias     = mean;
        test.expected = mean_over(groups[g], [&](std::size_t i) { return expected.s[i]; });
    }
    test.p = std::min(1.0, worst * static_cast<double>(groups.size()));
    std::nth_element(errors.begin(), errors.begin() + std::ptrdiff_t(errors.size() / 2), errors.end());
    test.resolution = errors[errors.size() / 2];
    return test;
}

std::function<VisibilityPlane(int seed)> seeded_planes(const MethodChoice& choice, const Scene& scene,
                                                       const SceneFacts& facts, const PointBatch& points,
                                                       LightId light) {
    return [&, choice, light](int seed) {
        Settings settings = choice.settings;
        settings.set(choice.info->seed, seed);
        Asked method(choice.info->make(settings));
        method.build(scene, facts);
        method.aim(light);
        return method.visibility(points, light);
    };
}

}  // namespace umbra
