// Methods of other kinds than ours, through the same contract: a program outside, a device with memory of its own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <fstream>

#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

// ---- a program outside: what it needs is there before the clock starts, a setting names it, and it may fail

struct OutsideOptions {
    std::string command;
    std::string folder;
};
const std::vector<Parameter> kOutsideParameters{
    parameter<&OutsideOptions::command>("command", "The program.", {.phase = Phase::build}),
    parameter<&OutsideOptions::folder>("folder", "For its files.", {.phase = Phase::build})};

template <class T>
void append(std::ofstream& out, const T& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

class OutsideMethod final : public MethodWith<OutsideOptions> {
public:
    explicit OutsideMethod(const Settings& settings) : MethodWith(settings) {}
    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::approximately, "A program."}; }
    void warm_up(const Scene& scene, const SceneFacts&) const override {
        std::ofstream out(options.folder + "/scene", std::ios::binary);
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            for (int k = 0; k < 3; ++k) append(out, dvec3(scene.vertex(t, k)));
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        std::ofstream out(options.folder + "/points", std::ios::binary);
        for (std::size_t i = 0; i < points.size(); ++i) {
            append(out, points.triangle[i] != kNoTriangle ? exact_position(built.scene, points, i) : dvec3(0));
            append(out, static_cast<double>(points.triangle[i]));
        }
        return std::make_unique<Looked>(points);
    }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const vec3 at = aimed.source().position;
        const int rc  = std::system(fmt::format("{0} {1}/scene {1}/points {2},{3},{4} {1}/answer", options.command,
                                                options.folder, at.x, at.y, at.z)
                                        .c_str());
        if (rc != 0) throw MethodError(fmt::format("the program ended with {}", rc));
        std::ifstream in(options.folder + "/answer", std::ios::binary);
        for (std::size_t i = 0; i < looked.points.size(); ++i) {
            float s = 0;
            in.read(reinterpret_cast<char*>(&s), sizeof s);
            if (looked.points.asks(aimed.light, i)) out.s[i] = s;
        }
    }
};

MethodInfo outside() {
    return {.name       = "outside",
            .title      = "A program",
            .paper      = "Nobody",
            .summary    = "A program.",
            .parameters = kOutsideParameters,
            .create     = create<OutsideMethod>};
}

TEST(Consumers, AProgramOutsideAnswersAsBruteForce) {
    const TemporaryFolder folder;
    const MethodInfo info = outside();
    MethodChoice choice(info);
    choice.settings.set("command", std::string_view(UMBRA_OUTSIDE_PROGRAM));
    choice.settings.set("folder", std::string_view(folder.path().string()));
    EXPECT_EQ(choice.text(),
              fmt::format("outside:command={},folder={}", UMBRA_OUTSIDE_PROGRAM, folder.path().string()));
    const PreparedScene prepared       = prepare_scene(std::string(UMBRA_SCENES) + "/light_inside_view.json", {64, 36});
    const auto& [scene, facts, points] = std::tie(prepared.scene, prepared.facts, prepared.points);
    const MethodRun run                = run_method(choice, scene, facts, points);
    const MethodRun force              = run_method(parse_method("brute_force"), scene, facts, points);
    std::size_t asked = 0, differ = 0;
    for (LightId j = 0; j < scene.lights.size(); ++j)
        for (std::size_t i = 0; i < points.size(); ++i) {
            asked += points.asks(j, i);
            differ += points.asks(j, i) && run.planes[j].s[i] != force.planes[j].s[i];
        }
    EXPECT_GT(asked, 500u);
    EXPECT_EQ(differ, 0u);

    choice.settings.set("command", std::string_view("false"));
    EXPECT_THROW((void)run_method(choice, scene, facts, points), MethodError);
}

// ---- a device: the points go there once for all lights

std::atomic<int> uploads = 0;

struct Uploaded final : Looked {
    explicit Uploaded(const PointBatch& at) : Looked(at) { ++uploads; }
    [[nodiscard]] std::size_t device_bytes() const override { return 16 * points.size(); }
};

class DeviceMethod final : public Method {
public:
    explicit DeviceMethod(const Settings&) {}
    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::approximately, "A device."}; }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built&, const PointBatch& points) const override {
        return std::make_unique<Uploaded>(points);
    }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& there = as<Uploaded>(looked);
        for (std::size_t i = 0; i < there.points.size(); ++i)
            if (there.points.asks(aimed.light, i)) out.s[i] = 1;
    }
};

TEST(Consumers, SixLightsShareOneUploadOfThePoints) {
    const MethodInfo info{.name    = "device",
                          .title   = "A device",
                          .paper   = "Nobody",
                          .summary = "A device.",
                          .create  = create<DeviceMethod>};
    const PreparedScene prepared = prepare_scene(std::string(UMBRA_SCENES) + "/six_lights.json", {64, 36});
    ASSERT_EQ(prepared.scene.lights.size(), 6u);
    uploads             = 0;
    const MethodRun run = run_method(MethodChoice(info), prepared.scene, prepared.facts, prepared.points);
    EXPECT_EQ(uploads, 1);
    EXPECT_EQ(run.times.visibility.size(), 6u);
    EXPECT_EQ(run.memory_bytes, 0u);
    EXPECT_EQ(run.device_bytes, 16u * 64 * 36);
}

}  // namespace
}  // namespace umbra
