// A method for tests that forgets to repeat a phase: what other methods do correctly, done once. Against the contract,
// it keeps what its phases made, and answers from that.
#pragma once

#include <map>
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

/// One caller at a time. All that is built is kept, since an old aim refers to it.
class LazyMethod final : public Method {
public:
    explicit LazyMethod(const Settings&) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override { return method_->serves(facts); }
    void warm_up(const Scene& scene, const SceneFacts& facts) const override { method_->warm_up(scene, facts); }
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        if (built_.empty() || !lazy_behaviour.builds_once) built_.push_back(method_->build(scene, facts));
        return std::make_unique<Built>(scene, facts);
    }
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        if (!aimed_[light] || !lazy_behaviour.aims_once) aimed_[light] = method_->aim(*built_.back(), light);
        return std::make_unique<Aimed>(built, light);
    }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const Aimed& kept = *aimed_.at(aimed.light);
        method_->visibility(kept, *method_->look(kept.built, looked.points), out);
    }

private:
    std::unique_ptr<const Method> method_ = parse_method(lazy_behaviour.method).make();
    mutable std::vector<std::unique_ptr<const Built>> built_;
    mutable std::map<LightId, std::unique_ptr<const Aimed>> aimed_;
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
