// The program `umbra` with a defect: every method that it makes is wrapped, and the wrapper throws where UMBRA_PLANT
// says, "METHOD PHASE LIGHT HOW [SCENE]". PHASE is build, aim, look, visibility or blame; LIGHT a number from 0, or "-"
// for any; SCENE names the only scene that is concerned. HOW: "exception"; "bad_alloc"; "worker" throws from a thread
// of a parallel loop; "unknown" throws what is no std::exception; "contract" answers 1.5; "hang" begins parallel loops
// for ever; "slow" sleeps for a second and a half, and goes on. The linker redirects MethodInfo::make to this file.
#include <chrono>
#include <cstdlib>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "umbra/bench/cli/command.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

struct Plant {
    std::string method, phase, light = "-", how, scene;
    Plant() {
        if (const char* text = std::getenv("UMBRA_PLANT"))
            std::istringstream(text) >> method >> phase >> light >> how >> scene;
    }
};

const Plant& plant() {
    static const Plant planted;
    return planted;
}

void fail() {
    const std::string& how = plant().how;
    if (how == "slow") {
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        return;
    }
    while (how == "hang")
        parallel_ranges(8, 1,
                        [](std::size_t, std::size_t) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
    if (how == "bad_alloc") throw std::bad_alloc();
    if (how == "unknown") throw 42;
    if (how == "worker")
        parallel_ranges(1000, 1, [](std::size_t begin, std::size_t) {
            if (begin == 500) throw std::runtime_error("a <planted> defect");
        });
    throw std::runtime_error("a <planted> defect");
}

/// Its values are those of the method that it wraps.
class Planted final : public Method {
public:
    explicit Planted(std::unique_ptr<const Method> method) : method_(std::move(method)) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override { return method_->serves(facts); }
    [[nodiscard]] bool multiplies() const override { return method_->multiplies(); }
    [[nodiscard]] Measure measures() const override { return method_->measures(); }
    void warm_up(const Scene& scene, const SceneFacts& facts) const override { method_->warm_up(scene, facts); }
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        if (is("build", scene)) fail();
        return method_->build(scene, facts);
    }
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        if (is("aim", built.scene, light)) fail();
        return method_->aim(built, light);
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        if (is("look", built.scene)) fail();
        return method_->look(built, points);
    }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const bool now = is("visibility", aimed.scene(), aimed.light);
        if (now && plant().how != "contract") fail();
        method_->visibility(aimed, looked, out);
        if (now) std::fill(out.s.begin(), out.s.end(), 1.5f);
    }
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        if (is("blame", aimed.scene(), aimed.light)) fail();
        method_->blame(aimed, looked, blockers);
    }
    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        return method_->explain(aimed, looked, i, given);
    }

private:
    /// `light`: none in a phase that is about no light.
    [[nodiscard]] static bool is(std::string_view phase, const Scene& scene, std::optional<LightId> light = {}) {
        return plant().phase == phase && (plant().scene.empty() || plant().scene == scene.name) &&
               (!light || plant().light == "-" || plant().light == std::to_string(*light));
    }
    std::unique_ptr<const Method> method_;
};

}  // namespace

// As the compiler names `MethodInfo::make(const Settings&) const` and the linker, under --wrap, its original.
#ifdef __clang__
#pragma clang diagnostic ignored "-Wreturn-type-c-linkage"  // C++ calls it, by its mangled name
#endif
extern "C" std::unique_ptr<const Method> __real__ZNK5umbra10MethodInfo4makeERKNS_8SettingsE(const MethodInfo*,
                                                                                            const Settings&);
extern "C" std::unique_ptr<const Method> __wrap__ZNK5umbra10MethodInfo4makeERKNS_8SettingsE(const MethodInfo* info,
                                                                                            const Settings& settings) {
    std::unique_ptr<const Method> method = __real__ZNK5umbra10MethodInfo4makeERKNS_8SettingsE(info, settings);
    if (info->name != plant().method) return method;
    return std::make_unique<Planted>(std::move(method));
}

}  // namespace umbra

int main(int argc, char** argv) { return umbra::run_command_line(argc, argv, umbra::commands()); }
