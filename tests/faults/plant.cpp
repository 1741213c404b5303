// The program `umbra` with a defect: every method that it makes is wrapped, and the wrapper throws where UMBRA_PLANT
// says, "METHOD PHASE LIGHT HOW [SCENE]". PHASE is build, aim, visibility or blame; LIGHT a number from 0, or "-" for
// any; SCENE names the only scene that is concerned. HOW: "exception"; "bad_alloc"; "worker" throws from a thread of a
// parallel loop; "unknown" throws what is no std::exception; "contract" answers 1.5. The linker redirects
// MethodInfo::make to this file.
#include <cstdlib>
#include <new>
#include <sstream>
#include <stdexcept>

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

[[noreturn]] void fail() {
    const std::string& how = plant().how;
    if (how == "bad_alloc") throw std::bad_alloc();
    if (how == "unknown") throw 42;
    if (how == "worker")
        parallel_ranges(1000, 1, [](std::size_t begin, std::size_t) {
            if (begin == 500) throw std::runtime_error("a <planted> defect");
        });
    throw std::runtime_error("a <planted> defect");
}

class Planted final : public Method {
public:
    explicit Planted(std::unique_ptr<Method> method) : method_(std::move(method)) {}

    void configure(const Settings& settings) override { method_->configure(settings); }
    [[nodiscard]] Service serves(const SceneFacts& facts) const override { return method_->serves(facts); }
    [[nodiscard]] Measure measures() const override { return method_->measures(); }
    [[nodiscard]] std::size_t memory_bytes() const override { return method_->memory_bytes(); }
    void build(const Scene& scene, const SceneFacts& facts) override {
        here_ = plant().scene.empty() || plant().scene == scene.name;
        if (is("build", 0)) fail();
        method_->build(scene, facts);
    }
    void aim(LightId light) override {
        if (is("aim", light)) fail();
        method_->aim(light);
    }
    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        const bool now = is("visibility", light);
        if (now && plant().how != "contract") fail();
        method_->visibility(points, light, out);
        if (now) std::fill(out.s.begin(), out.s.end(), 1.5f);
    }
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        if (is("blame", light)) fail();
        method_->blame(points, light, blockers);
    }

private:
    [[nodiscard]] bool is(std::string_view phase, LightId light) const {
        return here_ && plant().phase == phase &&
               (phase == "build" || plant().light == "-" || plant().light == std::to_string(light));
    }
    std::unique_ptr<Method> method_;
    bool here_ = true;
};

}  // namespace

// As the compiler names `MethodInfo::make(const Settings&) const` and the linker, under --wrap, its original.
#ifdef __clang__
#pragma clang diagnostic ignored "-Wreturn-type-c-linkage"  // C++ calls it, by its mangled name
#endif
extern "C" std::unique_ptr<Method> __real__ZNK5umbra10MethodInfo4makeERKNS_8SettingsE(const MethodInfo*,
                                                                                      const Settings&);
extern "C" std::unique_ptr<Method> __wrap__ZNK5umbra10MethodInfo4makeERKNS_8SettingsE(const MethodInfo* info,
                                                                                      const Settings& settings) {
    std::unique_ptr<Method> method = __real__ZNK5umbra10MethodInfo4makeERKNS_8SettingsE(info, settings);
    if (info->name != plant().method) return method;
    return std::make_unique<Planted>(std::move(method));
}

}  // namespace umbra

int main(int argc, char** argv) { return umbra::run_command_line(argc, argv); }
