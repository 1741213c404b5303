#include "umbra/shadows/soft/sample_layers.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "umbra/core/base/lanes.h"

namespace umbra::soft {
namespace {

constexpr float kBeyond         = 4;        ///< y above all rows
constexpr std::int32_t kLeftOut = 1 << 30;  ///< more layers than there are triangles

}  // namespace

SampleLayers::SampleLayers(int count, bool doubts)
    : count_(static_cast<std::size_t>(count)),
      doubts_(doubts),
      rows_(std::bit_ceil(count_)),
      last_row_(static_cast<std::int32_t>(rows_) - 1) {
    const std::size_t filled = (count_ + 7) / 8 * 8;
    x_.resize(filled);
    y_.resize(filled, kBeyond);
    unsorted_.resize(filled);
    row_.resize(filled);
    layers_.resize(filled);
    doubt_.resize(filled);
    begin_.resize(rows_ + 1);
}

/// Calls body(x, y, layers, doubt) for each eight samples that hold some of first .. end - 1.
template <class Body>
void SampleLayers::for_each_block(std::size_t first, std::size_t end, const Body& body) {
    for (std::size_t k = first / 8 * 8; k < end; k += 8) body(&x_[k], &y_[k], &layers_[k], &doubt_[k]);
}

/// Rows are as many as samples, about; y outside of the light belongs to the first or the last.
std::size_t SampleLayers::row_of(float y) const {
    const float row = (y + 1) * 0.5f * static_cast<float>(rows_);
    return row >= static_cast<float>(rows_) ? rows_ - 1 : row > 0 ? static_cast<std::size_t>(row) : 0;
}

UMBRA_FOR_EACH_PROCESSOR void SampleLayers::take(const rays::LightRays& light, PointKey key) {
    std::fill(layers_.begin(), layers_.end(), 0);
    std::fill(doubt_.begin(), doubt_.end(), 0);
    std::fill(begin_.begin(), begin_.end(), 0);
    const auto rows = static_cast<float>(rows_);
    for (std::size_t first = 0; first < count_; first += 8) {
        Samples8 samples;
        light.eight(key, static_cast<int>(first), samples);
        for (std::size_t k = 0; k < 8; ++k) {
            unsorted_[first + k] = {samples.x[k], samples.y[k]};
            row_[first + k]      = std::min(static_cast<std::int32_t>((samples.y[k] + 1) * 0.5f * rows), last_row_);
        }
    }
    for (std::size_t k = 0; k < count_; ++k) ++begin_[static_cast<std::size_t>(row_[k])];
    std::uint32_t end = 0;
    for (std::uint32_t& row : begin_) row = end += row;
    for (std::size_t k = 0; k < count_; ++k) {  // from the end of each row, which leaves its beginning
        const std::uint32_t i = --begin_[static_cast<std::size_t>(row_[k])];
        x_[i] = unsorted_[k].x, y_[i] = unsorted_[k].y;
    }
}

UMBRA_FOR_EACH_PROCESSOR void SampleLayers::add(const FlatEdge& edge, int change) {
    const std::int32_t entry = change * edge.entry, step = change * edge.step;
    if (entry != 0)
        for_each_block(begin_[row_of(edge.entry_y)], count_,
                       [=](const float*, const float* y, std::int32_t* layers, std::int32_t*) {
                           for (int k = 0; k < 8; ++k) layers[k] += y[k] >= edge.entry_y ? entry : 0;
                       });
    if (!edge.is_there) return;
    const vec2 e      = edge.high - edge.low;
    const float doubt = doubts_ ? edge.doubt : -1;
    const float bound = doubt * (std::abs(e.x) + e.y);
    const float low = edge.low.y - doubt, high = edge.high.y + doubt;
    for_each_block(begin_[row_of(edge.low.y - edge.doubt)], begin_[row_of(edge.high.y + edge.doubt) + 1],
                   [=](const float* x, const float* y, std::int32_t* layers, std::int32_t* doubtful) {
                       for (int k = 0; k < 8; ++k) {
                           // negative to the right of the edge
                           const float f = e.x * (y[k] - edge.low.y) - e.y * (x[k] - edge.low.x);
                           layers[k] += ((y[k] >= edge.low.y) & (y[k] < edge.high.y) & (f < 0)) ? step : 0;
                           doubtful[k] |= ((y[k] >= low) & (y[k] <= high) & (std::abs(f) <= bound)) ? 1 : 0;
                       }
                   });
}

UMBRA_FOR_EACH_PROCESSOR void SampleLayers::leave_out_behind(const rays::LightRays& light, const rays::SeenLight& seen,
                                                             const rays::Starts& starts, int lane, float latest) {
    ShadowPacket packet = rays::LightRays::packet_from(starts, lane);
    for (std::size_t first = 0; first < count_; first += 8) {
        Samples8 samples;
        std::copy_n(&x_[first], 8, samples.x);
        std::copy_n(&y_[first], 8, samples.y);
        light.direct(seen, samples, starts, lane, 8, packet);
        for (std::size_t k = 0; k < 8; ++k) {
            if (packet.valid[k] == 0)
                layers_[first + k] = kLeftOut, doubt_[first + k] = 0;
            else if (packet.tnear[k] > latest)
                doubt_[first + k] = 1;
        }
    }
}

UMBRA_FOR_EACH_PROCESSOR SampleLayers::Fewest SampleLayers::fewest() const {
    const std::int32_t *layers = layers_.data(), *doubt = doubt_.data();
    std::int32_t least = kLeftOut;
    for (std::size_t k = 0; k < count_; ++k) least = std::min(least, doubt[k] != 0 ? kLeftOut : layers[k]);
    Fewest found;
    if (least == kLeftOut) return found;
    for (std::size_t k = 0; k < count_; ++k) found.count += ((doubt[k] == 0) & (layers[k] == least)) ? 1 : 0;
    std::size_t k = 0;
    while (doubt[k] != 0 || layers[k] != least) ++k;
    found.sample = {x_[k], y_[k]};
    return found;
}

}  // namespace umbra::soft
