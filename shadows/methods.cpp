// The list of methods, and finding one by its name as typed.
#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

#include "umbra/core/base/error.h"
#include "umbra/core/base/suggest.h"
#include "umbra/core/base/trimmed.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/plugin.h"

namespace umbra {

// Each is defined in its method's file.
#define METHOD(name) extern const MethodInfo name;
#include "umbra/shadows/methods.def"
#undef METHOD

namespace {

const MethodInfo* method_of_plugin(const std::string& file) {
    void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw InputError(fmt::format("{}: cannot be loaded: {}", file, dlerror()));
    using Entry      = const MethodInfo* (*)(const PluginStamp&);
    const auto entry = reinterpret_cast<Entry>(dlsym(library, "umbra_plugin"));
    if (entry == nullptr)
        throw InputError(fmt::format("{}: is no plugin, expected UMBRA_PLUGIN(method) in its source", file));
    const MethodInfo* const method = entry(PluginStamp{});
    if (method == nullptr)
        throw InputError(
            fmt::format("{}: was compiled with another compiler or other headers than this program", file));
    return method;
}

/// Those of methods.def, in its order, and then those of the plugins that the environment names, with their files.
struct KnownMethods {
    std::vector<const MethodInfo*> all{
#define METHOD(name) &name,
#include "umbra/shadows/methods.def"
#undef METHOD
    };
    std::map<const MethodInfo*, std::string> files{};
    KnownMethods();
    void add(const std::string& plugin);
};

KnownMethods::KnownMethods() {
    const char* const plugins = std::getenv("UMBRA_PLUGINS");
    std::istringstream list(plugins != nullptr ? plugins : "");
    for (std::string file; std::getline(list, file, ':');)
        if (!file.empty()) add(file);
}

void KnownMethods::add(const std::string& plugin) {
    const MethodInfo* const method = method_of_plugin(plugin);
    if (std::ranges::find(all, method->name, &MethodInfo::name) != all.end())
        throw InputError(fmt::format("{}: there is already a method \"{}\"", plugin, method->name));
    all.push_back(method);
    files[method] = plugin;
}

KnownMethods& known_methods() {
    static KnownMethods known;
    return known;
}

/// Sets "k=v,k=v". No name may come twice.
void apply(std::string_view list, Settings& settings) {
    std::set<std::string_view> seen;
    for (const std::string_view pair : split(list, ',')) {
        const std::size_t eq = pair.find('=');
        if (eq == std::string_view::npos)
            throw UsageError(fmt::format("\"{}\": expected name=value, or several with commas between", pair));
        const auto name = pair.substr(0, eq);
        settings.set(name, pair.substr(eq + 1));
        if (!seen.insert(name).second) throw UsageError(fmt::format("{} is set twice", name));
    }
}

const Preset* find_preset(const MethodInfo& info, std::string_view name) {
    static constexpr Preset kDefault{"default", "", "All parameters at their defaults."};
    if (name == kDefault.name) return &kDefault;
    std::vector<std::string> known{std::string(kDefault.name)};
    for (const Preset& p : info.presets) {
        if (p.name == name) return &p;
        known.emplace_back(p.name);
    }
    refuse_unknown_name("unknown preset", name, known);
}

}  // namespace

Service verdict(const Method& method, const SceneFacts& facts) {
    Service service = method.serves(facts);
    if (service && facts.has_filters && !method.multiplies())
        return {How::not_at_all,
                "It knows lit and blocked alone, and here occluders let a part of the light through "
                "(\"transparent_occluders\": \"multiply\")."};
    if (service && facts.has_cutouts)
        return {How::approximately, service.why +
                                        " The outlines that a texture cuts out of surfaces are missing: the "
                                        "shadows are those of whole surfaces."};
    return service;
}

Reason Method::explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const {
    TriangleId blocker = kNoTriangle;
    if (given.answer != Answer::undefined && given.s < 1) {
        const auto which       = static_cast<std::uint32_t>(i);
        const PointBatch point = pick(looked.points, {&which, 1});
        blame(aimed, *look(aimed.built, point), {&blocker, 1});
    }
    return reason_by_geometry(aimed.scene(), looked.points, i, aimed.light, given, blocker);
}

std::string_view to_string(How how) {
    constexpr std::string_view kNames[]{"not", "approximately", "to_rounding", "exactly"};
    return kNames[static_cast<std::size_t>(how)];
}

std::span<const MethodInfo* const> methods() { return known_methods().all; }

void add_method(const MethodInfo& method) {
    auto& all = known_methods().all;
    if (std::ranges::find(all, method.name, &MethodInfo::name) != all.end())
        throw UsageError(fmt::format("there is already a method \"{}\"", method.name));
    all.push_back(&method);
}

void add_plugin(const std::string& file) { known_methods().add(file); }

std::string plugin_file(const MethodInfo& method) {
    const auto found = known_methods().files.find(&method);
    return found != known_methods().files.end() ? found->second : std::string();
}

const MethodInfo& find_method(std::string_view name) {
    return *entry_named("unknown method", name, methods(), &MethodInfo::name);
}

std::unique_ptr<const Method> MethodInfo::make(const Settings& settings) const { return create(settings); }

std::string MethodChoice::text() const {
    std::string text(info->name);
    char separator = ':';
    for (const Parameter& p : info->parameters) {
        if (settings.is_default(p.name)) continue;
        text += fmt::format("{}{}={}", separator, p.name, settings.text(p));
        separator = ',';
    }
    return text;
}

MethodChoice parse_method(std::string_view text) {
    const std::size_t colon = text.find(':');
    const auto head         = text.substr(0, colon);
    const std::size_t at    = head.find('@');
    MethodChoice choice(find_method(head.substr(0, at)));
    try {
        if (at != std::string_view::npos) {
            const Preset* preset = find_preset(*choice.info, head.substr(at + 1));
            if (!preset->settings.empty()) apply(preset->settings, choice.settings);
        }
        if (colon != std::string_view::npos) apply(text.substr(colon + 1), choice.settings);
    } catch (const UsageError& e) {
        throw UsageError(fmt::format("{}: {}", choice.info->name, e.what()));
    }
    return choice;
}

}  // namespace umbra
