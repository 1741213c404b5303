// A shared library in C as a method (include/umbra/contender.h).
#include <dlfcn.h>
#include <fmt/format.h>

#include <unistd.h>
#include <atomic>
#include <csignal>
#include <cstring>
#include <memory>
#include <mutex>

#include "umbra/bench/base/files.h"
#include "umbra/bench/contenders/answers_file.h"
#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/contenders/include/umbra/contender.h"
#include "umbra/core/base/error.h"
#include "umbra/core/scene/names.h"
#include "umbra/shadows/plugin.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

static_assert(sizeof(vec3) == 3 * sizeof(float) && sizeof(uvec3) == 3 * sizeof(std::uint32_t),
              "arrays are handed over as they are");

struct Library final : OutsideMethod {
    fs::path file;
    const umbra_contender_info* in_c = nullptr;
    IntroductionRecord says{};
    std::mutex mutex{};  ///< one call at a time

    [[nodiscard]] std::string text() const override { return bytes_of(file); }
};

// What a library is doing, for the handler of signals: a pointer to text that lives on.
std::atomic<const char*> running = nullptr;

extern "C" void say_who_crashed(int signal) {
    if (const char* const who = running.load()) {
        const auto say = [](const char* text) { static_cast<void>(!write(STDERR_FILENO, text, std::strlen(text))); };
        say("umbra: the program ends: a fault within the library "), say(who), say("\n");
    }
    std::signal(signal, SIG_DFL);
    static_cast<void>(raise(signal));
}

/// Says whose fault it is where a call of a library brings the program down.
class Running {
public:
    explicit Running(const Library& library) : before_(running.exchange(library.file.c_str())) {}
    ~Running() { running = before_; }
    Running(const Running&)            = delete;
    Running& operator=(const Running&) = delete;

private:
    const char* before_;
};

void copy(float (&to)[3], vec3 from) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }
void copy(double (&to)[3], dvec3 from) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }

/// Settings as the library reads them.
struct SettingsTable {
    std::vector<std::string> texts;
    std::vector<umbra_setting> values;

    explicit SettingsTable(const Settings& settings) {
        const auto parameters = settings.parameters();
        texts.reserve(parameters.size());
        for (const Parameter& p : parameters) {
            const bool has_text = p.type == Parameter::Type::choice || p.type == Parameter::Type::text;
            texts.push_back(has_text ? settings.text(p) : std::string());
            values.push_back({settings.value(p.name), texts.back().c_str()});
        }
    }
};
using Table = std::shared_ptr<const SettingsTable>;

umbra_light in_c(const Light& light) {
    umbra_light c{};
    c.kind = 1u << static_cast<unsigned>(light.kind);
    if (light.kind != LightKind::directional) copy(c.position, light.position);
    if (light.kind == LightKind::directional || light.kind == LightKind::spot || light.kind == LightKind::disk)
        copy(c.direction, light.direction);
    if (light.kind == LightKind::rectangle) copy(c.edge_u, light.edge_u), copy(c.edge_v, light.edge_v);
    if (light.kind == LightKind::disk || light.kind == LightKind::sphere) c.radius = light.radius;
    if (light.kind == LightKind::spot) c.cutoff = light.spot.cutoff;
    return c;
}
static_assert(UMBRA_SPHERE == 1 << static_cast<int>(LightKind::sphere) &&
              UMBRA_DIRECTIONAL == 1 << static_cast<int>(LightKind::directional));

umbra_points in_c(const PointBatch& points) {
    umbra_points c{};
    c.count    = points.size();
    c.triangle = points.triangle.data();
    c.u = points.u.data(), c.v = points.v.data();
    c.x = points.px.data(), c.y = points.py.data(), c.z = points.pz.data();
    c.nx = points.nx.data(), c.ny = points.ny.data(), c.nz = points.nz.data();
    c.number = points.numbers.empty() ? nullptr : points.numbers.data();
    if (points.raster) {
        const CameraFrame& frame = *points.raster;
        c.width = static_cast<std::uint32_t>(frame.width), c.height = static_cast<std::uint32_t>(frame.height);
        copy(c.camera.eye, frame.eye), copy(c.camera.forward, frame.forward);
        copy(c.camera.right, frame.right), copy(c.camera.up, frame.up);
        c.camera.half_width = frame.half_width, c.camera.half_height = frame.half_height;
        c.camera.orthographic = frame.projection == Projection::perspective ? 0 : 1;
    }
    return c;
}

/// What the library made in a phase, which it drops itself.
class Kept {
public:
    Kept(Library& library, Table settings) : library_(library), settings_(std::move(settings)) {}
    ~Kept() {
        if (value_ == nullptr || drop_ == nullptr) return;
        const std::lock_guard lock(library_.mutex);
        const Running now(library_);
        drop_(value_);
    }
    Kept(const Kept&)            = delete;
    Kept& operator=(const Kept&) = delete;

    using Make = int (*)(const umbra_question*, void**, char*);
    /// Throws MethodError where the library says that it cannot.
    void make(Make phase, void (*drop)(void*), umbra_question question, const char* name) {
        if (phase == nullptr) return;
        drop_             = drop;
        question.settings = settings_->values.data();
        char why[UMBRA_WHY]{};
        const std::lock_guard lock(library_.mutex);
        const Running now(library_);
        if (phase(&question, &value_, why) == 0) fail(name, why);
    }
    [[noreturn]] static void fail(const char* phase, char (&why)[UMBRA_WHY]) {
        why[UMBRA_WHY - 1] = '\0';
        throw MethodError(*why == '\0' ? fmt::format("{} failed, and says nothing of why", phase)
                                       : fmt::format("{}: {}", phase, why));
    }
    [[nodiscard]] const void* value() const { return value_; }

private:
    Library& library_;
    Table settings_;
    void (*drop_)(void*) = nullptr;
    void* value_         = nullptr;
};

class LibraryBuilt final : public Built {
public:
    LibraryBuilt(const Scene& of, const SceneFacts& its_facts, Library& library, const Table& settings)
        : Built(of, its_facts), kept(library, settings) {
        blocks_.reserve(of.triangles.size());
        for (TriangleId t = 0; t < of.triangles.size(); ++t) blocks_.push_back(of.blocks(t));
        c.vertices = of.positions.size(), c.triangles = of.triangles.size();
        c.positions = of.positions.empty() ? nullptr : &of.positions[0].x;
        c.corners   = of.triangles.empty() ? nullptr : &of.triangles[0].x;
        c.object = of.triangle_object.data(), c.blocks = blocks_.data();
        const Box box = bounds(of);
        if (!box.empty()) copy(c.low, box.min), copy(c.high, box.max);
        kept.make(library.in_c->build, library.in_c->drop_built, question(), "build");
    }
    [[nodiscard]] umbra_question question() const {
        umbra_question known{};
        known.scene = &c, known.built = kept.value();
        return known;
    }

private:
    umbra_scene c{};
    std::vector<std::uint8_t> blocks_{};
    Kept kept;
};

class LibraryAimed final : public Aimed {
public:
    LibraryAimed(const Built& from, LightId at, Library& library, const Table& settings)
        : Aimed(from, at), light(in_c(source())), kept(library, settings) {
        umbra_question question = as<LibraryBuilt>(from).question();
        question.light          = &light;
        kept.make(library.in_c->aim, library.in_c->drop_aimed, question, "aim");
    }
    const umbra_light light;
    Kept kept;
};

class LibraryLooked final : public Looked {
public:
    LibraryLooked(const Built& from, const PointBatch& at, Library& library, const Table& settings)
        : Looked(at), points_in_c(in_c(at)), kept(library, settings) {
        umbra_question question = as<LibraryBuilt>(from).question();
        question.points         = &points_in_c;
        kept.make(library.in_c->look, library.in_c->drop_looked, question, "look");
    }
    const umbra_points points_in_c;
    Kept kept;
};

class LibraryMethod final : public Method {
public:
    LibraryMethod(Library& library, const Settings& settings)
        : library_(library), settings_(std::make_shared<SettingsTable>(settings)) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        return serves_by_kind(library_.says, "library", facts);
    }
    [[nodiscard]] Measure measures() const override {
        return (library_.in_c->flags & UMBRA_IRRADIANCE) != 0 ? Measure::irradiance : Measure::area;
    }
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        return std::make_unique<LibraryBuilt>(scene, facts, library_, settings_);
    }
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        return std::make_unique<LibraryAimed>(built, light, library_, settings_);
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        return std::make_unique<LibraryLooked>(built, points, library_, settings_);
    }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& at           = as<LibraryAimed>(aimed);
        const auto& seen         = as<LibraryLooked>(looked);
        const PointBatch& points = looked.points;
        std::vector<std::uint8_t> asked(points.size());
        for (std::size_t i = 0; i < asked.size(); ++i) asked[i] = points.asks(aimed.light, i);
        umbra_question question = as<LibraryBuilt>(aimed.built).question();
        question.light = &at.light, question.points = &seen.points_in_c, question.settings = settings_->values.data();
        question.aimed = at.kept.value(), question.looked = seen.kept.value(), question.asked = asked.data();
        // Its own array: a library may write where it is not asked.
        std::vector<float> s(points.size(), std::numeric_limits<float>::quiet_NaN());
        const auto ask = [&](std::size_t begin, std::size_t end) {
            char why[UMBRA_WHY]{};
            if (library_.in_c->visibility(&question, begin, end, s.data(), why) == 0) Kept::fail("visibility", why);
        };
        {
            const std::lock_guard lock(library_.mutex);
            const Running now(library_);
            if ((library_.in_c->flags & UMBRA_THREADS) != 0)
                parallel_ranges(points.size(), 64, ask);
            else
                ask(0, points.size());
        }
        try {
            take_answers(s, points, aimed.light, "visibility", out);
        } catch (const InputError& e) {
            throw MethodError(e.what());  // costs its own cell
        }
    }

private:
    Library& library_;
    Table settings_;
};

static_assert(UMBRA_TEXT == static_cast<int>(Parameter::Type::text));

ParameterRecord record_of(const umbra_parameter& p, const std::string& from) {
    const auto text = [](const char* t) { return std::string(t == nullptr ? "" : t); };
    if (p.type > UMBRA_TEXT)
        throw InputError(fmt::format("{}: parameter {:?}: type {}, expected UMBRA_INTEGER to UMBRA_TEXT, 0 to 4", from,
                                     text(p.name), p.type));
    ParameterRecord record{.name     = text(p.name),
                           .type     = std::string(to_string(static_cast<Parameter::Type>(p.type))),
                           .fallback = text(p.fallback),
                           .phase    = text(p.phase),
                           .doc      = text(p.doc),
                           .choices  = text(p.choices),
                           .sweep    = text(p.sweep)};
    if (p.min != 0 || p.max != 0) record.min = p.min, record.max = p.max;
    return record;
}

/// Throws InputError where the struct cannot be a contender.
IntroductionRecord introduction_of(const umbra_contender_info& info, const std::string& from) {
    if (info.version != UMBRA_CONTENDER_VERSION)
        throw InputError(fmt::format("{}: was compiled for version {} of umbra/contender.h, expected {}", from,
                                     info.version, UMBRA_CONTENDER_VERSION));
    for (const auto& [member, name] :
         {std::pair(info.name, "name"), std::pair(info.title, "title"), std::pair(info.release, "release")})
        if (member == nullptr || *member == '\0') throw InputError(fmt::format("{}: {} is missing", from, name));
    if (info.visibility == nullptr) throw InputError(fmt::format("{}: visibility is NULL, expected a function", from));
    if (info.parameter_count > 0 && info.parameters == nullptr)
        throw InputError(fmt::format("{}: parameters is NULL, expected {} of them", from, info.parameter_count));
    if ((info.lights & ~63u) != 0 || (info.flags & ~3u) != 0)
        throw InputError(fmt::format("{}: lights is {:#x} and flags {:#x}, expected bits that umbra/contender.h names",
                                     from, info.lights, info.flags));
    IntroductionRecord says{.name    = info.title,
                            .version = info.release,
                            .summary = info.summary == nullptr ? "" : info.summary,
                            .takes   = "points",
                            .seed    = info.seed == nullptr ? "" : info.seed};
    says.measure = (info.flags & UMBRA_IRRADIANCE) != 0 ? "irradiance" : "area";
    for (const auto& kind : EnumNames<LightKind>::table)
        if ((info.lights & 1u << static_cast<unsigned>(kind.value)) != 0) says.lights.emplace_back(kind.name);
    for (std::uint32_t k = 0; k < info.parameter_count; ++k)
        says.parameters.push_back(record_of(info.parameters[k], from));
    check_introduction(says, from);
    return says;
}

/// dlopen of exactly this file, never of one in the system's folders.
void* loaded(const fs::path& file) {
    if (!fs::is_regular_file(file))
        throw InputError(fmt::format("{}: is not there, or is no regular file", file.string()));
    void* const library = dlopen(fs::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw InputError(fmt::format("{}: cannot be loaded: {}", file.string(), dlerror()));
    return library;
}

using Entry = const umbra_contender_info* (*)();
Entry entry_of(const fs::path& file) { return reinterpret_cast<Entry>(dlsym(loaded(file), "umbra_contender")); }

}  // namespace

const MethodInfo& library_method(const fs::path& file) {
    const Entry entry = entry_of(file);
    if (entry == nullptr)
        throw InputError(fmt::format("{}: exports no umbra_contender(), see umbra/contender.h", file.string()));
    static std::once_flag once;
    std::call_once(once, [] {
        for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, say_who_crashed);
    });
    auto made        = std::make_unique<Library>();
    Library& library = *made;
    library.file     = file;
    const Running now(library);
    library.in_c = entry();
    if (library.in_c == nullptr) throw InputError(fmt::format("{}: umbra_contender() returns NULL", file.string()));
    library.says = introduction_of(*library.in_c, file.string());
    library.introduce(library.in_c->name, library.says, "library");
    library.info.create = [&library](const Settings& settings) -> std::unique_ptr<const Method> {
        return std::make_unique<LibraryMethod>(library, settings);
    };
    return keep_outside(std::move(made));
}

void add_library_method(const fs::path& file) {
    if (dlsym(loaded(file), "umbra_plugin") != nullptr)
        add_plugin(file.string());
    else
        add_method(library_method(file));
}

}  // namespace umbra
