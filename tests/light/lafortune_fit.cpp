#include "umbra/tests/light/lafortune_fit.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/NonLinearOptimization>

#include "umbra/core/render/brdf.h"

namespace umbra {
namespace {

constexpr int kOfDiffuse = 3, kOfLobe = 13;
constexpr double kLargestExponent = 12;  ///< of the logarithm of n

/// Exponents are fitted by their logarithms, so that none is negative.
Material material_of(const Eigen::VectorXd& x, int lobes) {
    Material m;
    m.k_d = vec3(float(x[0]), float(x[1]), float(x[2]));
    for (int i = 0; i < lobes; ++i) {
        const Eigen::Index at = kOfDiffuse + kOfLobe * i;
        const auto number     = [&](int k) { return static_cast<float>(x[at + k]); };
        LafortuneLobe lobe;
        lobe.k_s = {number(0), number(1), number(2)};
        for (int row = 0; row < 3; ++row)
            lobe.rows[static_cast<std::size_t>(row)] = {number(3 + 3 * row), number(4 + 3 * row), number(5 + 3 * row)};
        lobe.shininess = static_cast<float>(std::exp(std::min(x[at + 12], kLargestExponent)));
        m.lobes.push_back(lobe);
    }
    return m;
}

/// Residuals and their derivatives, which are known in closed form.
class Residuals {
public:
    using Scalar       = double;
    using InputType    = Eigen::VectorXd;
    using ValueType    = Eigen::VectorXd;
    using JacobianType = Eigen::MatrixXd;

    Residuals(std::span<const ReflectanceSample> samples, int lobes) : samples_(samples), lobes_(lobes) {}

    [[nodiscard]] int inputs() const { return kOfDiffuse + kOfLobe * lobes_; }
    [[nodiscard]] int values() const { return static_cast<int>(3 * samples_.size()); }

    int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& out) const {
        for (std::size_t s = 0; s < samples_.size(); ++s) {
            const ReflectanceSample& sample = samples_[s];
            for (int c = 0; c < 3; ++c) {
                double value = x[c] * sample.l.z;
                for (int i = 0; i < lobes_; ++i) value += x[start(i) + c] * power(x, i, sample);
                out[row(s, c)] = value - sample.value[c];
            }
        }
        return 0;
    }

    int df(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const {
        jacobian.setZero();
        for (std::size_t s = 0; s < samples_.size(); ++s) {
            const ReflectanceSample& sample = samples_[s];
            for (int c = 0; c < 3; ++c) jacobian(row(s, c), c) = sample.l.z;
            for (int i = 0; i < lobes_; ++i) {
                const Eigen::Index at = start(i);
                const double cosine   = bent(x, i, sample);
                if (!(cosine > 0)) continue;
                const double n = exponent(x, i), p = std::pow(cosine, n);
                for (int c = 0; c < 3; ++c) {
                    const double k_s            = x[at + c];
                    jacobian(row(s, c), at + c) = p;
                    for (int r = 0; r < 3; ++r)
                        for (int k = 0; k < 3; ++k)
                            jacobian(row(s, c), at + 3 + 3 * r + k) = k_s * n * p / cosine * sample.v[r] * sample.l[k];
                    jacobian(row(s, c), at + 12) = k_s * n * p * std::log(cosine);
                }
            }
        }
        return 0;
    }

private:
    static Eigen::Index row(std::size_t sample, int channel) { return static_cast<Eigen::Index>(3 * sample) + channel; }
    static Eigen::Index start(int lobe) { return kOfDiffuse + kOfLobe * lobe; }
    static double exponent(const Eigen::VectorXd& x, int lobe) {
        return std::exp(std::min(x[start(lobe) + 12], kLargestExponent));
    }
    /// e . C l
    static double bent(const Eigen::VectorXd& x, int lobe, const ReflectanceSample& sample) {
        double sum = 0;
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 3; ++k) sum += sample.v[r] * x[start(lobe) + 3 + 3 * r + k] * sample.l[k];
        return sum;
    }
    static double power(const Eigen::VectorXd& x, int lobe, const ReflectanceSample& sample) {
        const double cosine = bent(x, lobe, sample);
        return cosine > 0 ? std::pow(cosine, exponent(x, lobe)) : 0;
    }

    std::span<const ReflectanceSample> samples_;
    int lobes_;
};

Eigen::VectorXd start_of(std::span<const ReflectanceSample> samples, int lobes) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(kOfDiffuse + kOfLobe * lobes);
    double largest    = 0;
    for (const ReflectanceSample& sample : samples)
        for (int c = 0; c < 3; ++c) {
            x[c] += sample.value[c] / static_cast<double>(samples.size());
            largest = std::max(largest, sample.value[c]);
        }
    for (int i = 0; i < lobes; ++i) {
        const Eigen::Index at = kOfDiffuse + kOfLobe * i;
        for (int c = 0; c < 3; ++c) x[at + c] = largest / (2 * lobes);
        x[at + 3] = x[at + 7] = -1, x[at + 11] = 1;
        x[at + 12] = std::log(4.0) * (i + 1);
    }
    return x;
}

}  // namespace

LafortuneFit fit_lafortune(std::span<const ReflectanceSample> samples, int lobes) {
    if (lobes < 0 || lobes > 8)
        throw std::invalid_argument(fmt::format("fit_lafortune: {} lobes, expected 0 to 8", lobes));
    Residuals residuals(samples, lobes);
    if (residuals.values() < residuals.inputs())
        throw std::invalid_argument(
            fmt::format("fit_lafortune: {} numbers for {} parameters", residuals.values(), residuals.inputs()));
    Eigen::VectorXd x = start_of(samples, lobes);
    Eigen::LevenbergMarquardt<Residuals> search(residuals);
    search.parameters.maxfev = 2000;
    const int status         = search.minimize(x);
    Eigen::VectorXd left(residuals.values());
    residuals(x, left);
    LafortuneFit fit;
    fit.material  = material_of(x, lobes);
    fit.rms       = left.norm() / std::sqrt(static_cast<double>(residuals.values()));
    fit.converged = status > 0 && status != Eigen::LevenbergMarquardtSpace::TooManyFunctionEvaluation;
    return fit;
}

}  // namespace umbra
