// A method at work on one scene, as tests ask it: its values are made once and kept until their phase is repeated.
#pragma once

#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/scene/facts.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// Keeps what the last `build` and the last `aim` made. `visibility` and `blame` look at the batch that they are given,
/// each time, and may run in several threads at once.
class Asked {
public:
    explicit Asked(std::unique_ptr<const Method> method) : method_(std::move(method)) {}
    explicit Asked(const MethodInfo& info) : Asked(info.make()) {}
    explicit Asked(const MethodChoice& choice) : Asked(choice.make()) {}
    explicit Asked(std::string_view typed) : Asked(parse_method(typed)) {}  ///< "NAME@PRESET:k=v"

    [[nodiscard]] const Method& method() const { return *method_; }
    [[nodiscard]] Service serves(const SceneFacts& facts) const { return method_->serves(facts); }
    [[nodiscard]] Measure measures() const { return method_->measures(); }

    /// `scene` must outlive this, or the next build.
    void build(const Scene& scene, SceneFacts facts) {
        aimed_.reset(), built_.reset();
        facts_ = std::make_unique<const SceneFacts>(std::move(facts));
        method_->warm_up(scene, *facts_);
        built_ = method_->build(scene, *facts_);
    }
    void build(const Scene& scene) { build(scene, find_facts(scene)); }
    void aim(LightId light) {
        aimed_.reset();
        aimed_ = method_->aim(built(), light);
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const PointBatch& points) const {
        return method_->look(built(), points);
    }
    void visibility(const PointBatch& points, LightId light, const Visibility& out) const {
        write_decided(built().scene, points, light, out);
        method_->visibility(aimed_at(light), *look(points), out);
    }
    [[nodiscard]] VisibilityPlane visibility(const PointBatch& points, LightId light) const {
        VisibilityPlane plane(points.size());
        visibility(points, light, plane.out());
        return plane;
    }
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
        method_->blame(aimed_at(light), *look(points), blockers);
    }

    [[nodiscard]] const Built& built() const { return made(built_); }
    [[nodiscard]] const Aimed& aimed() const { return made(aimed_); }
    /// Of what build and aim made.
    [[nodiscard]] std::size_t memory_bytes() const {
        return built().memory_bytes() + (aimed_ ? aimed_->memory_bytes() : 0);
    }

private:
    template <class Value>
    static const Value& made(const std::unique_ptr<const Value>& value) {
        if (!value) throw std::logic_error("the test asks for what no phase has made");
        return *value;
    }
    [[nodiscard]] const Aimed& aimed_at(LightId light) const {
        if (aimed().light != light) throw std::logic_error("the test asks for a light that it did not aim at");
        return aimed();
    }

    std::unique_ptr<const Method> method_;
    std::unique_ptr<const SceneFacts> facts_;  // of the last build, whose value refers to it
    std::unique_ptr<const Built> built_;
    std::unique_ptr<const Aimed> aimed_;
};

}  // namespace umbra
