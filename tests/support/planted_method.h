// A method for tests that is wrong in a way that the test chooses: it stands for any method whose answers are known.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "umbra/shadows/method.h"

namespace umbra {

/// What it answers at one pixel.
struct PlantedAnswer {
    float s      = 0;
    bool defined = true;
};

/// Set by a test before a run and read by every object of the method.
struct PlantedBehaviour {
    /// At the pixel in column x, row y from the top; of points that are no picture, x is the index.
    std::function<PlantedAnswer(LightId light, std::size_t x, std::size_t y, int seed)> answer;
    std::function<void(Phase phase, LightId light)> work;  ///< called in each phase, light 0 where it is about none;
                                                           ///< may be empty
    std::function<bool(vec3 position)> blames_own;         ///< its shadow there comes from the point's own triangle
    TriangleId blamed        = kNoTriangle;                ///< for its shadow elsewhere
    std::size_t memory_bytes = 0;
};
inline PlantedBehaviour planted_behaviour;

struct PlantedOptions {
    int seed = 0;
};

class PlantedMethod final : public MethodWith<PlantedOptions> {
public:
    explicit PlantedMethod(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::approximately, "planted"}; }
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        work(Phase::build, 0);
        return std::make_unique<Geometry>(scene, facts);
    }
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        work(Phase::aim, light);
        return MethodWith::aim(built, light);
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        work(Phase::look, 0);
        return MethodWith::look(built, points);
    }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        work(Phase::visibility, aimed.light);
        const PointBatch& points = looked.points;
        const LightId light      = aimed.light;
        const std::size_t width  = points.raster ? static_cast<std::size_t>(points.raster->width) : points.size();
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!points.asks(light, i)) continue;
            const PlantedAnswer a = planted_behaviour.answer(light, i % width, i / width, options.seed);
            // As sparing as a method may be: what is 0 and given is there already.
            if (!a.defined)
                out.answer[i] = Answer::undefined;
            else if (a.s > 0)
                out.s[i] = a.s;
        }
    }
    void blame(const Aimed&, const Looked& looked, std::span<TriangleId> blockers) const override {
        const PointBatch& points = looked.points;
        for (std::size_t i = 0; i < points.size(); ++i)
            blockers[i] = planted_behaviour.blames_own && planted_behaviour.blames_own(points.position(i))
                              ? points.triangle[i]
                              : planted_behaviour.blamed;
    }

private:
    struct Geometry final : Built {
        using Built::Built;
        [[nodiscard]] std::size_t memory_bytes() const override { return planted_behaviour.memory_bytes; }
    };
    static void work(Phase phase, LightId light) {
        if (planted_behaviour.work) planted_behaviour.work(phase, light);
    }
};

/// The method as `CompareOptions::choices` takes it; `seed`: "seed" where its answers depend on one.
inline MethodInfo planted_method(std::string_view seed = {}) {
    MethodInfo info;
    info.name       = "planted";
    info.title      = "Planted";
    info.paper      = "Nobody, Wrong on Purpose";
    info.summary    = "Wrong where a test says so.";
    info.parameters = {parameter<&PlantedOptions::seed>("seed", "Noise.", {.min = 0, .max = 2147483647})};
    info.seed       = seed;
    info.create     = create<PlantedMethod>;
    return info;
}

}  // namespace umbra
