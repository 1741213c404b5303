// The contract of a shadow method: one question, which fraction S_j of light j does each surface point see?
//
// A method is one file (shadows/NAME.cpp, which defines `extern const MethodInfo NAME`) and one line in methods.def.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility_plane.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/settings.h"

namespace umbra {

enum class How : std::uint8_t { not_at_all, approximately, exactly };
[[nodiscard]] std::string_view to_string(How how);  ///< "not", "approximately", "exactly"

/// How well a method serves a scene, and why: an answer, not an error.
struct Service {
    How how = How::exactly;
    std::string why;  ///< one sentence, always given
    explicit operator bool() const { return how != How::not_at_all; }
};

/// The three phases are timed apart: a moving object reruns all, a light the last two, a camera the last.
/// Calls come in this order from one thread; a method does its own parallelism (core/base/parallel.h) and its results
/// do not depend on the number of threads.
class Method {
public:
    Method()                         = default;
    virtual ~Method()                = default;
    Method(const Method&)            = delete;
    Method& operator=(const Method&) = delete;

    /// From the scene's facts alone. The other members are called only where this is not `not_at_all`.
    [[nodiscard]] virtual Service serves(const SceneFacts& facts) const = 0;

    /// What depends on geometry alone. `scene` and `facts` must outlive this object. May be called again.
    virtual void build(const Scene& scene, const SceneFacts& facts) = 0;

    /// What depends on one light. `visibility` may be asked for this light until the next aim; called again where it
    /// moved.
    virtual void aim(LightId light) = 0;

    /// Writes s[i] in [0, 1] for every point i of the batch, and defined[i] = 0 where the method cannot tell (1 else).
    /// Before the call s is 0 and defined is 1 everywhere, which is the answer for points whose facing[light] is `none`
    /// or `away`: skip those. `light` is the one aimed at. Batches without a raster are served, unless documented.
    virtual void visibility(const PointBatch& points, LightId light, std::span<float> s,
                            std::span<std::uint8_t> defined) = 0;

    /// For the last call of `visibility`: how far each s[i] may be from the truth at most, where the method answers
    /// with the middle of a proven bracket. Empty where it states no such bound, or where nothing is left open.
    [[nodiscard]] virtual std::span<const float> half_widths() const { return {}; }

    /// Which triangle the method holds responsible where it says shadow: writes one of the blocking triangles a point,
    /// for points (a batch without a raster) that `visibility` has answered with less than 1 for this light;
    /// kNoTriangle where it can name none. Asked after the timed phases, to explain errors; need not be fast.
    virtual void blame(const PointBatch& /*points*/, LightId /*light*/, std::span<TriangleId> who) {
        std::fill(who.begin(), who.end(), kNoTriangle);
    }

    /// Memory held after build and aim, bytes, counted from the containers' sizes.
    [[nodiscard]] virtual std::size_t memory_bytes() const = 0;
};

/// A method as the list knows it. All members but `make` are for people.
struct MethodInfo {
    std::string_view name;     ///< as typed: "shadow_zbuffer"
    std::string_view title;    ///< "Shadow z-buffer"
    std::string_view paper;    ///< author, title, year
    std::string_view summary;  ///< one or two sentences: what it does, where it errs
    std::span<const Parameter> parameters;
    std::unique_ptr<Method> (*make)(const Settings& settings) = nullptr;
};

/// All methods, in report order.
[[nodiscard]] std::span<const MethodInfo* const> methods();

/// Throws UsageError, naming the methods that there are.
[[nodiscard]] const MethodInfo& find_method(std::string_view name);

/// "NAME" or "NAME:k=v,k=v": the method and its settings. Throws UsageError, naming what would be right.
struct MethodChoice {
    const MethodInfo* info = nullptr;
    Settings settings;
    [[nodiscard]] std::string text() const;  ///< "NAME" or "NAME:k=v,..." with what differs from the defaults
};
[[nodiscard]] MethodChoice parse_method(std::string_view text);

template <class T>
std::unique_ptr<Method> make_method(const Settings& settings) {
    return std::make_unique<T>(settings);
}

}  // namespace umbra
