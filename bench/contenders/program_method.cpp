// A program from outside as a method: one process for each value of `build`, used again where that is dropped.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/contenders/program_session.h"
#include "umbra/bench/out/files.h"
#include "umbra/core/base/error.h"
#include "umbra/core/scene/names.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

/// All that lives as long as the process: the record that the views of `info` look into, and idle programs.
struct Contender {
    std::string name, title, paper, summary;
    ContenderRecord record;
    fs::path folder;
    std::deque<std::string> texts;  ///< that parameters look into
    MethodInfo info;
    std::mutex mutex{};  ///< guards what follows
    std::vector<std::unique_ptr<ProgramSession>> idle{};
    std::map<std::string, OwnTimes> own_times{};  ///< by settings and scene

    [[nodiscard]] std::unique_ptr<ProgramSession> session() {
        {
            const std::lock_guard lock(mutex);
            while (!idle.empty()) {
                auto session = std::move(idle.back());
                idle.pop_back();
                if (session->is_alive()) return session;
            }
        }
        auto session = std::make_unique<ProgramSession>(record.command, folder, record.timeout_s);
        IntroductionRecord says;
        try {
            says = from_record<IntroductionRecord>(session->hello());
        } catch (const InputError& e) {
            throw MethodError(e.what());
        }
        if (says.version != record.says.version)
            throw MethodError(
                fmt::format("the program says that it is version {}, but {} was checked: check it again "
                            "(umbra contender check {})",
                            says.version, record.says.version, name));
        return session;
    }
    void give_back(std::unique_ptr<ProgramSession> session) {
        session->looked = session->aimed = nullptr;
        if (!session->is_alive()) return;
        const std::lock_guard lock(mutex);
        idle.push_back(std::move(session));
    }
};

Json settings_of(const Settings& settings) {
    Json all = Json::object();
    for (const Parameter& p : settings.parameters()) switch (p.type) {
            case Parameter::Type::boolean: all[std::string(p.name)] = settings.value(p.name) != 0; break;
            case Parameter::Type::integer:
                all[std::string(p.name)] = static_cast<std::int64_t>(settings.value(p.name));
                break;
            case Parameter::Type::real: all[std::string(p.name)] = settings.value(p.name); break;
            case Parameter::Type::choice:
            case Parameter::Type::text: all[std::string(p.name)] = settings.text(p); break;
        }
    return all;
}

/// One scene is one file (and frame) to the clock of the program.
std::string key_of(const Json& settings, const Scene& scene) {
    return fmt::format("{}#{}#{}#{}", settings.dump(), scene.source, scene.name, scene.frame);
}

class ProgramBuilt final : public Built {
public:
    ProgramBuilt(const Scene& of, const SceneFacts& its_facts, Contender& who, std::unique_ptr<ProgramSession> its)
        : Built(of, its_facts), contender(who), session(std::move(its)) {}
    ~ProgramBuilt() override { contender.give_back(std::move(session)); }
    Contender& contender;
    std::unique_ptr<ProgramSession> session;
    mutable std::mutex mutex{};  ///< guards the session
};

class Program final : public Method {
public:
    Program(Contender& contender, const Settings& settings) : contender_(contender), settings_(settings_of(settings)) {}
    ~Program() override {
        if (ready_) contender_.give_back(std::move(ready_));
    }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        const auto& known = contender_.record.says.lights;
        for (const LightFacts& light : facts.lights)
            if (std::ranges::find(known, to_string(light.kind)) == known.end())
                return {How::not_at_all, fmt::format("“{}” is a {} light; it takes {}", light.name,
                                                     to_string(light.kind), fmt::join(known, ", "))};
        return {How::approximately, fmt::format("{} is a program from outside, version {}", contender_.record.says.name,
                                                contender_.record.says.version)};
    }

    [[nodiscard]] Measure measures() const override {
        return contender_.record.says.measure == to_string(Measure::irradiance) ? Measure::irradiance : Measure::area;
    }

    [[nodiscard]] std::optional<OwnTimes> own_times(const Scene& scene) const override {
        const std::lock_guard lock(contender_.mutex);
        const auto found = contender_.own_times.find(key_of(settings_, scene));
        return found == contender_.own_times.end() ? std::nullopt : std::optional(found->second);
    }

    void warm_up(const Scene& scene, const SceneFacts&) const override {
        const std::lock_guard lock(mutex_);
        if (!ready_ || !ready_->is_alive()) ready_ = contender_.session();
        ready_->send(scene_message(ready_->folder(), scene, settings_));
    }

    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        std::unique_ptr<ProgramSession> session;
        {
            const std::lock_guard lock(mutex_);
            session = std::move(ready_);
        }
        if (!session) throw std::logic_error("a program is built without warm_up");
        const double ms = session->send(build_message(settings_));
        note(
            scene, ms, [](OwnTimes & all) -> auto& { return all.build; });
        return std::make_unique<ProgramBuilt>(scene, facts, contender_, std::move(session));
    }

    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        const auto& there = as<ProgramBuilt>(built);
        auto made         = std::make_unique<Aimed>(built, light);
        const std::lock_guard lock(there.mutex);
        take_aim(there, *made);
        return made;
    }

    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        const auto& there = as<ProgramBuilt>(built);
        auto made         = std::make_unique<Looked>(points);
        const std::lock_guard lock(there.mutex);
        take_points(there, *made);
        return made;
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& there = as<ProgramBuilt>(aimed.built);
        const std::lock_guard lock(there.mutex);
        ProgramSession& session = *there.session;
        if (session.aimed != &aimed) take_aim(there, aimed);
        if (session.looked != &looked) take_points(there, looked);
        const double ms = session.answers(visibility_message(session.folder(), looked.points, aimed.light, settings_),
                                          there.scene, looked.points, aimed.light, out);
        if (looked.points.raster)  // a few points, asked to explain errors, are no sample
            note(
                there.scene, ms, [&](OwnTimes & all) -> auto& { return all.visibility[aimed.light]; });
    }

private:
    template <class Which>
    void note(const Scene& scene, double ms, const Which& which) const {
        if (std::isnan(ms)) return;
        const std::lock_guard lock(contender_.mutex);
        which(contender_.own_times[key_of(settings_, scene)]).push_back(ms);
    }
    void take_aim(const ProgramBuilt& there, const Aimed& aimed) const {
        const double ms = there.session->send(aim_message(there.scene, aimed.light, settings_));
        note(
            there.scene, ms, [&](OwnTimes & all) -> auto& { return all.aim[aimed.light]; });
        there.session->aimed = &aimed;
    }
    void take_points(const ProgramBuilt& there, const Looked& looked) const {
        const double ms =
            there.session->send(points_message(there.session->folder(), there.scene, looked.points, settings_));
        if (looked.points.raster)
            note(
                there.scene, ms, [](OwnTimes & all) -> auto& { return all.look; });
        there.session->looked = &looked;
    }

    Contender& contender_;
    Json settings_;
    mutable std::mutex mutex_{};  ///< guards ready_
    mutable std::unique_ptr<ProgramSession> ready_{};
};

constexpr std::array kTypes{Parameter::Type::integer, Parameter::Type::real, Parameter::Type::choice,
                            Parameter::Type::boolean, Parameter::Type::text};
constexpr std::array kPhases{Phase::build, Phase::aim, Phase::look, Phase::visibility};

template <class Values>
std::optional<typename Values::value_type> by_name(const Values& values, std::string_view name) {
    for (const auto value : values)
        if (to_string(value) == name) return value;
    return std::nullopt;
}

std::deque<Contender>& all_programs() {
    static std::deque<Contender> all;
    return all;
}

std::string_view kept(Contender& contender, std::string text) { return contender.texts.emplace_back(std::move(text)); }

Parameter parameter_of(Contender& contender, const ParameterRecord& from) {
    const auto fail = [&](const std::string& what) {
        return InputError(fmt::format("{}: parameter {:?}: {}", contender.name, from.name, what));
    };
    Parameter p;
    check_method_name(from.name);
    p.name    = kept(contender, from.name);
    p.doc     = kept(contender, from.doc);
    p.unit    = kept(contender, from.unit);
    p.choices = kept(contender, from.choices);
    p.sweep   = kept(contender, from.sweep);
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
        p.fallback_text = kept(contender, fallback);
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

std::string text_of_program(const MethodInfo& method) {
    std::string text;
    for (const Contender& contender : all_programs()) {
        if (&contender.info != &method) continue;
        text = json_text(to_record(contender.record));
        for (const std::string& word : contender.record.command) {
            const fs::path file = contender.folder / word;
            if (fs::is_regular_file(file)) text += bytes_of(file);
        }
    }
    return text;
}

const MethodInfo& program_method(const std::string& name, const ContenderRecord& record, const fs::path& folder) {
    std::deque<Contender>& all = all_programs();
    check_method_name(name);
    check_introduction(record.says, name);
    if (record.command.empty()) throw InputError(fmt::format("{}: \"command\" is missing or empty", name));
    Contender& contender = all.emplace_back();
    contender.name       = name;
    contender.record     = record;
    contender.folder     = folder.empty() ? fs::path(".") : folder;
    contender.title      = fmt::format("{} {}", record.says.name, record.says.version);
    contender.paper      = "A program from outside, which times itself too";
    contender.summary    = record.says.summary.empty() ? "A program from outside." : record.says.summary;
    MethodInfo& info     = contender.info;
    info                 = {.name         = contender.name,
                            .title        = contender.title,
                            .paper        = contender.paper,
                            .summary      = contender.summary,
                            .by_default   = false,
                            .needs_raster = record.says.takes == "raster",
                            .create       = [&contender](const Settings& settings) -> std::unique_ptr<const Method> {
                return std::make_unique<Program>(contender, settings);
            },
                            .outside = "program"};
    for (const ParameterRecord& p : record.says.parameters) info.parameters.push_back(parameter_of(contender, p));
    for (const Parameter& p : info.parameters)
        if (p.name == record.says.seed) info.seed = p.name;
    return info;
}

IntroductionRecord introduction(const std::vector<std::string>& command, const fs::path& folder, double timeout_s) {
    const ProgramSession session(command, folder, timeout_s);
    IntroductionRecord says;
    try {
        says = from_record<IntroductionRecord>(session.hello());
        check_introduction(says, "answer to hello");
    } catch (const InputError& e) {
        throw MethodError(e.what());
    }
    return says;
}

}  // namespace umbra
