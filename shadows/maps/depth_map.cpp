#include "umbra/shadows/maps/depth_map.h"

#include <algorithm>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr std::size_t kCleared = 1 << 18;  // samples cleared by one task

double unorm_max(DepthFormat format) {
    switch (format) {
        case DepthFormat::unorm16: return 0xffff;
        case DepthFormat::unorm24: return 0xffffff;
        case DepthFormat::unorm32: return 0xffffffff;
        case DepthFormat::float32: break;
    }
    return 1;
}

}  // namespace

DepthMap::DepthMap(int width, int height, DepthFormat format)
    : width_(width),
      height_(height),
      format_(format),
      step_(1 / unorm_max(format)),
      far_word_(format == DepthFormat::float32 ? kFarWord : static_cast<std::uint32_t>(unorm_max(format))),
      words_(std::make_unique_for_overwrite<std::uint32_t[]>(samples())) {
    clear();
}

void DepthMap::clear() {
    parallel_ranges(samples(), kCleared, [&](std::size_t begin, std::size_t end) {
        std::fill(words_.get() + begin, words_.get() + end, far_word_);
    });
}

void DepthMap::draw(const dmat4& clip_from_world, std::span<const vec3> positions,
                    std::span<const std::span<const uvec3>> runs, Faces faces) {
    keep_nearest({width_, height_, code(), clip_from_world, positions, runs, faces}, words_.get());
}

void DepthMap::draw_behind(const DepthMap& first, const dmat4& clip_from_world, std::span<const vec3> positions,
                           std::span<const std::span<const uvec3>> runs, Faces faces) {
    constexpr std::uint32_t kRoundings = 8;  // of a surface that is drawn twice, as two triangles with other corners
    keep_nearest_behind({width_, height_, code(), clip_from_world, positions, runs, faces}, first.words_.get(),
                        kRoundings, words_.get());
}

void DepthMap::move_towards(const DepthMap& first, const std::function<double(double, double)>& between) {
    parallel_ranges(samples(), kCleared, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (words_[i] != far_word_)
                words_[i] = depth_word(code(), between(decode(first.words_[i]), decode(words_[i])));
    });
}

std::vector<std::uint32_t> DepthMap::owners(const dmat4& clip_from_world, std::span<const vec3> positions,
                                            std::span<const uvec3> all, std::span<const std::span<const uvec3>> runs,
                                            Faces faces, std::span<const std::size_t> samples) const {
    std::vector<std::uint32_t> owners(samples.size(), kNoOwner);
    keep_owners({width_, height_, code(), clip_from_world, positions, runs, faces}, words_.get(), all, samples, owners);
    return owners;
}

}  // namespace umbra
