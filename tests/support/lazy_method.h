// A method for tests that forgets to repeat a phase: what other methods do correctly, done once.
#pragma once

#include <memory>
#include <string>

#include "umbra/shadows/method.h"

namespace umbra {

/// Set by a test before a run and read when an object is made.
struct LazyBehaviour {
    std::string method = "shadow_volumes";  ///< what does the work
    bool builds_once = false, aims_once = false;
};
inline LazyBehaviour lazy_behaviour;

struct LazyOptions {
    int unused = 0;
};

class LazyMethod final : public MethodWith<LazyOptions> {
public:
    [[nodiscard]] Service serves(const SceneFacts& facts) const override { return method_->serves(facts); }
    void build(const Scene& scene, const SceneFacts& facts) override {
        if (!built_ || !lazy_behaviour.builds_once) method_->build(scene, facts);
        built_ = true;
    }
    void aim(LightId light) override {
        if (!aimed_ || !lazy_behaviour.aims_once) method_->aim(light);
        aimed_ = true;
    }
    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        method_->visibility(points, light, out);
    }
    [[nodiscard]] std::size_t memory_bytes() const override { return method_->memory_bytes(); }

private:
    std::unique_ptr<Method> method_ = parse_method(lazy_behaviour.method).make();
    bool built_ = false, aimed_ = false;
};

/// A method of this name that works as lazy_behaviour says.
inline MethodInfo lazy_method() {
    MethodInfo info;
    info.name    = "lazy";
    info.title   = "Lazy";
    info.paper   = "Nobody, Twice Is Too Often";
    info.summary = "Forgets to repeat what a test says.";
    info.create  = create<LazyMethod>;
    return info;
}

}  // namespace umbra
