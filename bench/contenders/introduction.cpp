#include "umbra/bench/contenders/introduction.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <regex>
#include <set>
#include <sstream>

#include "umbra/core/base/error.h"
#include "umbra/core/scene/names.h"

namespace umbra {
namespace {

std::vector<std::unique_ptr<OutsideMethod>>& outside_methods() {
    static std::vector<std::unique_ptr<OutsideMethod>> all;
    return all;
}

constexpr std::array kTypes{Parameter::Type::integer, Parameter::Type::real, Parameter::Type::choice,
                            Parameter::Type::boolean, Parameter::Type::text};
constexpr std::array kPhases{Phase::build, Phase::aim, Phase::look, Phase::visibility};

template <class Values>
std::optional<typename Values::value_type> by_name(const Values& values, std::string_view name) {
    for (const auto value : values)
        if (to_string(value) == name) return value;
    return std::nullopt;
}

std::string_view kept(OutsideMethod& of, std::string text) { return of.texts.emplace_back(std::move(text)); }

Parameter parameter_of(OutsideMethod& of, const ParameterRecord& from) {
    const auto fail = [&](const std::string& what) {
        return InputError(fmt::format("{}: parameter {:?}: {}", of.name, from.name, what));
    };
    Parameter p;
    check_method_name(from.name);
    p.name    = kept(of, from.name);
    p.doc     = kept(of, from.doc);
    p.unit    = kept(of, from.unit);
    p.choices = kept(of, from.choices);
    p.sweep   = kept(of, from.sweep);
    p.type    = by_name(kTypes, from.type).value_or(Parameter::Type::real);
    if (!from.phase.empty() && !by_name(kPhases, from.phase))
        throw fail(fmt::format("phase {:?}, expected build, aim, look or visibility", from.phase));
    p.phase           = by_name(kPhases, from.phase).value_or(Phase::visibility);
    const double most = p.type == Parameter::Type::integer ? 2147483647.0 : std::numeric_limits<double>::max();
    p.min             = from.min.value_or(-most);
    p.max             = from.max.value_or(most);
    if (p.type == Parameter::Type::choice && p.choices.empty()) throw fail("no choices, expected \"a|b|c\"");
    const std::string fallback = text_of(from.fallback);
    if (fallback.empty() && p.type != Parameter::Type::text) throw fail("\"default\" is missing");
    if (p.type == Parameter::Type::text)
        p.fallback_text = kept(of, fallback);
    else
        try {
            p.fallback = p.parse(fallback);
        } catch (const UsageError& e) {
            throw fail(fmt::format("default {}", e.what()));
        }
    std::istringstream values(from.sweep);
    for (std::string value; std::getline(values, value, '|');) try {
            static_cast<void>(p.parse(value));
        } catch (const UsageError& e) {
            throw fail(fmt::format("sweep {}", e.what()));
        }
    return p;
}

}  // namespace

void check_method_name(const std::string& name) {
    if (!std::regex_match(name, std::regex("[A-Za-z_][A-Za-z0-9_]{0,63}")))
        throw UsageError(
            fmt::format("{:?} is no name of a method or a parameter: expected letters, digits and underscores, "
                        "the first no digit, at most 64",
                        name));
}

void check_introduction(const IntroductionRecord& says, const std::string& from) {
    for (const std::string& text : {says.name, says.version, says.summary})
        if (text.size() > 500 || std::ranges::any_of(text, [](unsigned char c) { return c < 32; }))
            throw InputError(
                fmt::format("{}: \"name\", \"version\" and \"summary\" are one line of at most 500 bytes", from));
    if (says.lights.empty())
        throw InputError(
            fmt::format("{}: \"lights\" is missing or empty, expected kinds of lights that the program takes", from));
    bool area = false;
    for (const std::string& kind : says.lights) {
        const auto& table = EnumNames<LightKind>::table;
        const auto found  = std::ranges::find(table, kind, &Named<LightKind>::name);
        if (found == table.end())
            throw InputError(
                fmt::format("{}: \"lights\" has {:?}, expected directional, point, spot, rectangle, disk or "
                            "sphere",
                            from, kind));
        area = area || is_area(found->value);
    }
    if (area && says.measure.empty())
        throw InputError(
            fmt::format("{}: \"measure\" is missing: a program that takes lights with an area says whether it "
                        "answers \"area\" or \"irradiance\"",
                        from));
    std::set<std::string> names;
    for (const ParameterRecord& p : says.parameters)
        if (!names.insert(p.name).second)
            throw InputError(fmt::format("{}: parameter {:?} is given twice", from, p.name));
    if (!says.seed.empty() && !names.contains(says.seed))
        throw InputError(fmt::format("{}: \"seed\" is {:?}, which is none of its parameters", from, says.seed));
}

void OutsideMethod::introduce(const std::string& as, const IntroductionRecord& says, const std::string& kind) {
    check_method_name(as);
    name  = as;
    title = fmt::format("{} {}", says.name, says.version);
    if (std::ranges::any_of(methods(), [&](const MethodInfo* m) { return m->name != as && m->title == title; }))
        title += ", " + as;  // one program twice, with other words of its command
    paper   = fmt::format("A {} from outside", kind);
    summary = says.summary.empty() ? paper + "." : says.summary;
    info    = {.name         = name,
               .title        = title,
               .paper        = paper,
               .summary      = summary,
               .by_default   = false,
               .needs_raster = says.takes == "raster",
               .outside      = kind};
    for (const ParameterRecord& p : says.parameters) info.parameters.push_back(parameter_of(*this, p));
    for (const Parameter& p : info.parameters)
        if (p.name == says.seed) info.seed = p.name;
}

const MethodInfo& keep_outside(std::unique_ptr<OutsideMethod> method) {
    return outside_methods().emplace_back(std::move(method))->info;
}

std::string text_of_outside(const MethodInfo& method) {
    for (const auto& outside : outside_methods())
        if (&outside->info == &method) return outside->text();
    return "";
}

void end_idle_programs() {
    for (const auto& outside : outside_methods()) outside->end_idle();
}

Service serves_by_kind(const IntroductionRecord& says, const std::string& kind, const SceneFacts& facts) {
    for (const LightFacts& light : facts.lights)
        if (std::ranges::find(says.lights, to_string(light.kind)) == says.lights.end())
            return {How::not_at_all, fmt::format("“{}” is a {} light; it takes {}", light.name, to_string(light.kind),
                                                 fmt::join(says.lights, ", "))};
    return {How::approximately, fmt::format("{} is a {} from outside, version {}", says.name, kind, says.version)};
}

}  // namespace umbra
