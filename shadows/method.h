// The contract of a shadow method: one question, which fraction S_j of light j does each surface point see?
//
// A method is one file (shadows/ROOM/NAME.cpp, which defines `extern const MethodInfo NAME`) and one line in
// methods.def; docs/adding_a_method.md follows one from the first line to a green test run.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/settings.h"

namespace umbra {

/// How a method's answers relate to those of an exact method, from worst to best.
enum class How : std::uint8_t {
    not_at_all,     ///< it does not serve the scene
    approximately,  ///< a tolerance, a sampling density or a missing effect of its own changes answers
    to_rounding,    ///< it evaluates the true condition in floating point, with no tolerance of its own: only rounding
                    ///< can change an answer
    exactly         ///< by proof, no answer differs from the truth beyond the half width that comes with it
};
[[nodiscard]] std::string_view to_string(How how);  ///< "not", "approximately", "to_rounding", "exactly"

/// How well a method serves a scene, and why: an answer, not an error.
struct Service {
    How how = How::approximately;
    std::string why;  ///< one sentence, always given
    explicit operator bool() const { return how != How::not_at_all; }
};

class Method;

/// What a method says of a scene (Method::serves); `not_at_all` where occluders let a part of the light through and the
/// method does not compute that (Method::multiplies).
[[nodiscard]] Service verdict(const Method& method, const SceneFacts& facts);

/// One method with one set of parameters. Calls come from one thread at a time, except that `visibility` and `blame`
/// may run in several threads at once; a method does its own parallelism (core/base/parallel.h), and its results do not
/// depend on the number of threads.
///
/// The three phases are timed apart: a moving object repeats all of them, a light the last two, a camera the last.
/// Each phase does its own work, so that its time is what the movement costs.
///
/// Errors. `configure`, `build` and `aim` throw UsageError where the parameters cannot be had for this scene (what to
/// change is in the message), and std::bad_alloc; `visibility` and `blame` throw std::bad_alloc alone. After an
/// exception the object may be configured and built again.
class Method {
public:
    Method()                         = default;
    virtual ~Method()                = default;
    Method(const Method&)            = delete;
    Method& operator=(const Method&) = delete;

    /// Takes the parameters. Called before anything else, and again where they change: then the phases from the first
    /// changed parameter's on are called again (first_changed_phase), and what earlier phases made is still there.
    virtual void configure(const Settings& settings) = 0;

    /// From the scene's facts alone, as if no triangle let a part of the light through: callers ask `verdict`, which
    /// knows of those. The phases are called only where that is not `not_at_all`.
    [[nodiscard]] virtual Service serves(const SceneFacts& facts) const = 0;

    /// Whether S_j is multiplied by Scene::lets_through of what lies between the point and the light. Every method
    /// leaves triangles out that do not block (Scene::blocks).
    [[nodiscard]] virtual bool multiplies() const { return false; }

    /// Which fraction it answers. A method is compared with the truth of the same measure.
    [[nodiscard]] virtual Measure measures() const { return Measure::area; }

    /// What depends on geometry alone. `scene` and `facts` must outlive this object. May be called again.
    virtual void build(const Scene& scene, const SceneFacts& facts) = 0;

    /// What depends on one light. `visibility` may be asked for this light until the next aim; called again where it
    /// moved.
    virtual void aim(LightId light) = 0;

    /// Writes S_j for every point that asks for it (`points.asks(light, i)`): s in [0, 1], `undefined` where the method
    /// cannot tell, a half width where it proves one. Other entries stay as they are, which is the answer there.
    /// `light` is the one aimed at. Batches without a raster are served, unless MethodInfo::needs_raster.
    virtual void visibility(const PointBatch& points, LightId light, Visibility out) const = 0;

    /// Which triangle the method holds responsible where it says shadow: writes one of the blocking triangles a point,
    /// for points (a batch without a raster) that `visibility` has answered with less than 1 for this light;
    /// kNoTriangle where it can name none. Asked after the timed phases, to explain errors; need not be fast.
    virtual void blame(const PointBatch& /*points*/, LightId /*light*/, std::span<TriangleId> blockers) const {
        std::fill(blockers.begin(), blockers.end(), kNoTriangle);
    }

    /// Memory held after build and aim, bytes, counted from the containers' sizes; 0 where it holds none.
    [[nodiscard]] virtual std::size_t memory_bytes() const = 0;
};

/// A method that reads its parameters from `options`, a struct of its own.
template <class Options>
class MethodWith : public Method {
public:
    void configure(const Settings& settings) override { options = settings.as<Options>(); }

protected:
    Options options;
};

/// A named set of settings, typed METHOD@NAME.
struct Preset {
    std::string_view name;      ///< "textbook", "fast", "best"; every method has "default"
    std::string_view settings;  ///< "k=v,k=v"
    std::string_view doc;       ///< one sentence
};

/// A method as the list knows it. What the rest of the program needs to know of a method is here, so that no other file
/// has to know a name.
struct MethodInfo {
    std::string_view name;     ///< as typed: "shadow_zbuffer"
    std::string_view title;    ///< "Shadow z-buffer"
    std::string_view paper;    ///< author, title, year
    std::string_view summary;  ///< one or two sentences: what it does, where it errs
    std::vector<Parameter> parameters{};
    std::vector<Preset> presets{};
    bool reference  = false;  ///< its answers may serve as truth: the first such method that serves a scene
    bool by_default = true;   ///< it runs where nobody says which methods; false for what is too slow for that
    std::vector<std::string_view> shown_on{};  ///< where it is not by default: canonical scenes on which it runs where
                                               ///< nobody says which methods, so that reports show it
    bool needs_raster = false;                 ///< it serves only batches that have a raster
    std::string_view seed{};                   ///< the parameter that seeds its noise; empty: it has none
    std::string_view stand_in{};  ///< settings with which it is the substitute where no reference serves, or where one
                                  ///< takes too long at every point; empty: it never is
    std::unique_ptr<Method> (*create)() = nullptr;  ///< not configured yet

    /// Whether reports show it, on all scenes or on some.
    [[nodiscard]] bool is_shown() const { return by_default || !shown_on.empty(); }

    /// Created and configured. Throws UsageError where the settings contradict one another.
    [[nodiscard]] std::unique_ptr<Method> make(const Settings& settings) const;
    /// The same with all defaults.
    [[nodiscard]] std::unique_ptr<Method> make() const { return make(Settings(parameters)); }
};

/// All methods, in report order.
[[nodiscard]] std::span<const MethodInfo* const> methods();

/// Throws UsageError, naming the methods that there are.
[[nodiscard]] const MethodInfo& find_method(std::string_view name);

/// A method and its settings.
struct MethodChoice {
    const MethodInfo* info = nullptr;
    Settings settings;

    explicit MethodChoice(const MethodInfo& method) : info(&method), settings(method.parameters) {}  ///< all defaults
    [[nodiscard]] std::string text() const;  ///< "NAME" or "NAME:k=v,..." with what differs from the defaults
    [[nodiscard]] std::unique_ptr<Method> make() const { return info->make(settings); }
};

/// "NAME", "NAME@PRESET", "NAME:k=v,k=v" or "NAME@PRESET:k=v": the method and its settings. Throws UsageError: what was
/// found, what is expected.
[[nodiscard]] MethodChoice parse_method(std::string_view text);

template <class T>
std::unique_ptr<Method> create() {
    return std::make_unique<T>();
}

}  // namespace umbra
