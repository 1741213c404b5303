// The contract of a shadow method: one question, which fraction S_j of light j does each surface point see?
//
// A method is one file (shadows/ROOM/NAME.cpp, which defines `extern const MethodInfo NAME`) and one line in
// methods.def; docs/adding_a_method.md follows one from the first line to a green test run.
#pragma once

#include <algorithm>
#include <cassert>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/reason.h"
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

/// The result of a phase: const, for any thread, at one address, so that others may refer to it. The arguments of the
/// phase must outlive it; the Method need not.
class Value {
public:
    Value()                        = default;
    virtual ~Value()               = default;
    Value(const Value&)            = delete;
    Value& operator=(const Value&) = delete;

    /// Memory that it holds, bytes, counted from the containers' sizes; without what it refers to.
    [[nodiscard]] virtual std::size_t memory_bytes() const { return 0; }
    /// The same in the memory of a device.
    [[nodiscard]] virtual std::size_t device_bytes() const { return 0; }
};

/// The result of `build`, which depends on geometry alone. Methods derive from this and the next two to keep anything.
class Built : public Value {
public:
    Built(const Scene& of, const SceneFacts& its_facts) : scene(of), facts(its_facts) {}
    const Scene& scene;
    const SceneFacts& facts;
};

/// The result of `aim`, which depends on geometry and on one light.
class Aimed : public Value {
public:
    Aimed(const Built& from, LightId at) : built(from), light(at) {}
    [[nodiscard]] const Scene& scene() const { return built.scene; }
    [[nodiscard]] const Light& source() const { return built.scene.lights[light]; }
    const Built& built;
    const LightId light;
};

/// The result of `look`, which depends on geometry and on the surface points, and serves all lights.
class Looked : public Value {
public:
    explicit Looked(const PointBatch& at) : points(at) {}
    const PointBatch& points;
};

/// A value as the type that the method's own phase made it.
template <class Own>
[[nodiscard]] const Own& as(const Value& value) {
    assert(dynamic_cast<const Own*>(&value) != nullptr);
    return static_cast<const Own&>(value);
}

/// What a method from outside says its phases took: every sample, milliseconds.
struct OwnTimes {
    std::vector<double> build{}, look{};
    std::map<LightId, std::vector<double>> aim{}, visibility{};
};

class Method;

/// Method::serves, but `not_at_all` where occluders let a part of the light through and the method does not compute
/// that (Method::multiplies), and at best `approximately` where outlines are not computed (SceneFacts::has_cutouts).
[[nodiscard]] Service verdict(const Method& method, const SceneFacts& facts);

/// One method with one set of parameters, which never change. Its phases are functions: each makes a value from its
/// arguments and keeps nothing. All members may be called from any thread; a method does its own parallelism
/// (core/base/parallel.h), and its results do not depend on the number of threads.
///
///     build(scene) ----> Built --+--> aim(light) ----> Aimed  --+--> visibility, blame, explain
///                                +--> look(points) --> Looked --+
///
/// The phases are timed apart. An object that moved repeats all; a light repeats its own aim and visibility; the camera
/// repeats look, once for all lights, and visibility. Each phase does its own work, so that its time is that of the
/// movement. A value also serves settings that differ only in parameters of later phases (first_changed_phase).
///
/// Errors. Every phase may throw MethodError, where the method failed, and std::bad_alloc; the constructor, `build` and
/// `aim` also UsageError where the parameters cannot be had for this scene: the message says what to change.
class Method {
public:
    Method()                         = default;
    virtual ~Method()                = default;
    Method(const Method&)            = delete;
    Method& operator=(const Method&) = delete;

    /// From the scene's facts alone, as if no triangle let a part of the light through: callers ask `verdict`. The
    /// phases are called only where that is not `not_at_all`.
    [[nodiscard]] virtual Service serves(const SceneFacts& facts) const = 0;

    /// Whether S_j is multiplied by Scene::lets_through of the triangles between the point and the light. Every method
    /// leaves triangles out that do not block (Scene::blocks).
    [[nodiscard]] virtual bool multiplies() const { return false; }

    /// Which fraction it answers. A method is compared with the truth of the same measure.
    [[nodiscard]] virtual Measure measures() const { return Measure::area; }

    /// What a method from outside says its phases took on this scene, so far, with these settings; nothing where there
    /// is no clock but ours.
    [[nodiscard]] virtual std::optional<OwnTimes> own_times(const Scene& /*scene*/) const { return std::nullopt; }

    /// Called before each `build`, outside the clock: for preparations that are not the method's own work, as starting
    /// a program, or writing the scene to a file for it.
    virtual void warm_up(const Scene& /*scene*/, const SceneFacts& /*facts*/) const {}

    [[nodiscard]] virtual std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const {
        return std::make_unique<Built>(scene, facts);
    }

    [[nodiscard]] virtual std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const {
        return std::make_unique<Aimed>(built, light);
    }

    /// Batches without a raster are served, unless MethodInfo::needs_raster. The lights may have moved since `build`;
    /// the batch's `facing` is up to date in `visibility`, and may change between this call and that.
    [[nodiscard]] virtual std::unique_ptr<const Looked> look(const Built& /*built*/, const PointBatch& points) const {
        return std::make_unique<Looked>(points);
    }

    /// Writes S_j for every point that asks for it (`points.asks(light, i)`): s in [0, 1], `undefined` where the method
    /// cannot tell, a half width where it proves one. Random numbers of a point depend on PointBatch::number, so that
    /// it has the same answer whoever else is asked. Other entries stay as they are, which is the answer there. Both
    /// values come from one Built.
    virtual void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const = 0;

    /// Which triangle the method holds responsible where it says shadow: writes one of the blocking triangles a point,
    /// for points (a batch without a raster) that `visibility` has answered with less than 1 for this light;
    /// kNoTriangle where it can name none. Asked after the timed phases, to explain errors; need not be fast.
    virtual void blame(const Aimed& /*aimed*/, const Looked& /*looked*/, std::span<TriangleId> blockers) const {
        std::fill(blockers.begin(), blockers.end(), kNoTriangle);
    }

    /// Why `visibility` gave this answer, whichever, at point i, which asks for the light. The default is the geometric
    /// reason with the triangle that `blame` names; methods add the values that they compared.
    [[nodiscard]] virtual Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const;

protected:
    /// For `visibility`: body(i) for the points that ask for the light, of about `grain` points in a row. Parallel.
    template <class Body>
    static void for_each_asked(const Aimed& aimed, const Looked& looked, std::size_t grain, const Body& body) {
        parallel_ranges(looked.points.size(), grain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                if (looked.points.asks(aimed.light, i)) body(i);
        });
    }

    /// For `blame`: find(i) for the points that ask for the light, kNoTriangle for others. Parallel.
    template <class Find>
    static void blame_each(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers, const Find& find) {
        parallel_ranges(blockers.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                blockers[i] = looked.points.asks(aimed.light, i) ? find(i) : kNoTriangle;
        });
    }
};

struct NoOptions {};  ///< of a method without parameters

/// A method that reads its parameters from `options`, a struct of its own, and whose phases make these types: OwnBuilt of
/// the scene and its facts, OwnAimed of that and a light, OwnLooked of OwnBuilt and the points; each also of `options`
/// where it takes them.
template <class Options, class OwnBuilt = Built, class OwnAimed = Aimed, class OwnLooked = Looked>
class MethodWith : public Method {
public:
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        return made<OwnBuilt>(scene, facts);
    }
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        return made<OwnAimed>(as<OwnBuilt>(built), light);
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        if constexpr (std::is_same_v<OwnLooked, Looked>)
            return Method::look(built, points);
        else
            return made<OwnLooked>(as<OwnBuilt>(built), points);
    }

protected:
    explicit MethodWith(const Settings& settings) : options(settings.as<Options>()) {}
    const Options options;

private:
    template <class Made, class... From>
    [[nodiscard]] std::unique_ptr<const Made> made(const From&... from) const {
        if constexpr (std::is_constructible_v<Made, const From&..., const Options&>)
            return std::make_unique<Made>(from..., options);
        else
            return std::make_unique<Made>(from...);
    }
};

/// A named set of settings, typed METHOD@NAME.
struct Preset {
    std::string_view name;      ///< "textbook", "fast", "best"; every method has "default"
    std::string_view settings;  ///< "k=v,k=v"
    std::string_view doc;       ///< one sentence
};

/// A method as the list knows it: all that the rest of the program knows of a method, so that no other file names one.
struct MethodInfo {
    std::string_view name;     ///< as typed: "shadow_zbuffer"
    std::string_view title;    ///< "Shadow z-buffer"
    std::string_view paper;    ///< author, title, year
    std::string_view summary;  ///< one or two sentences: what it does, where it errs
    std::vector<Parameter> parameters{};
    std::vector<Preset> presets{};
    bool reference  = false;    ///< its answers may serve as truth: the first such method that serves a scene
    bool by_default = true;     ///< it runs where no methods are named; false where it is too slow
    bool shown      = false;    ///< where it is not by default: reports show it on the scenes that name it
                                ///< (scenes/canonical.txt), and on ladders
    bool needs_raster = false;  ///< it serves only batches that have a raster
    std::string_view seed{};    ///< the parameter that seeds its noise; empty: it has none
    std::function<std::unique_ptr<const Method>(const Settings& settings)> create{};  ///< create<T>
    std::string outside{};  ///< of a method from outside: what it is ("program", "file of answers"); else empty
    bool is_timed = true;   ///< false: its phases only hand out what was computed elsewhere

    /// Whether reports show it, on all scenes or on some.
    [[nodiscard]] bool is_shown() const { return by_default || shown; }

    /// Throws UsageError where the settings contradict one another.
    [[nodiscard]] std::unique_ptr<const Method> make(const Settings& settings) const;
    /// The same with all defaults.
    [[nodiscard]] std::unique_ptr<const Method> make() const { return make(Settings(parameters)); }
};

/// All methods, in report order: those of methods.def, then those of plugins (shadows/plugin.h), then those that were
/// added. Throws InputError at the first call, where a plugin cannot be had.
[[nodiscard]] std::span<const MethodInfo* const> methods();

/// Adds a method, which must outlive all calls; before other threads look at the list. Throws UsageError where there is
/// one of its name.
void add_method(const MethodInfo& method);

/// Throws UsageError, naming the methods that there are.
[[nodiscard]] const MethodInfo& find_method(std::string_view name);

/// A method and its settings.
struct MethodChoice {
    const MethodInfo* info = nullptr;
    Settings settings;

    explicit MethodChoice(const MethodInfo& method) : info(&method), settings(method.parameters) {}  ///< all defaults
    [[nodiscard]] std::string text() const;  ///< "NAME" or "NAME:k=v,..." without defaults
    [[nodiscard]] std::unique_ptr<const Method> make() const { return info->make(settings); }
};

/// "NAME", "NAME@PRESET", "NAME:k=v,k=v" or "NAME@PRESET:k=v": the method and its settings. Throws UsageError.
[[nodiscard]] MethodChoice parse_method(std::string_view text);

/// T is the method's class, which is made of its settings.
template <class T>
std::unique_ptr<const Method> create(const Settings& settings) {
    return std::make_unique<T>(settings);
}

}  // namespace umbra
