// A program from outside as a method: one process for each value of `build`, used again where that is dropped.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "umbra/bench/base/files.h"
#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/contenders/program_session.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

bool is_script(const fs::path& file) {
    return fs::is_regular_file(file) && (file.extension() == ".py" || file.extension() == ".js");
}

/// Bytes of a word that is a file. What a script imports is not known: all scripts beside it count.
std::string text_of_word(const fs::path& word) {
    if (!is_script(word)) return fs::is_regular_file(word) ? bytes_of(word) : "";
    std::vector<fs::path> scripts;
    for (const auto& entry : fs::directory_iterator(word.parent_path()))
        if (is_script(entry.path())) scripts.push_back(entry.path());
    std::ranges::sort(scripts);
    std::string text = word.filename().string();
    for (const fs::path& script : scripts) text += bytes_of(script);
    return text;
}

struct Contender final : OutsideMethod {
    ContenderRecord record;
    fs::path folder;
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
        if (const IntroductionRecord& says = session->says(); says.version != record.says.version)
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
    [[nodiscard]] std::string text() const override {
        std::string text = json_text(to_record(record));
        for (const std::string& word : record.command) text += text_of_word(folder / word);
        return text;
    }
    void end_idle() override {
        const std::lock_guard lock(mutex);
        idle.clear();
    }
};

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
    Program(Contender& contender, const Settings& settings)
        : contender_(contender), settings_(to_record(parameter_records(settings))) {}
    ~Program() override {
        if (ready_) contender_.give_back(std::move(ready_));
    }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        return serves_by_kind(contender_.record.says, "program", facts);
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
        // Of points without a raster, which explain errors, a program that takes pictures alone is not told.
        if (!points.raster && contender_.record.says.takes == "raster") return made;
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

}  // namespace

const MethodInfo& program_method(const std::string& name, const ContenderRecord& record, const fs::path& folder) {
    check_introduction(record.says, name);
    if (record.command.empty()) throw InputError(fmt::format("{}: \"command\" is missing or empty", name));
    auto made    = std::make_unique<Contender>();
    made->record = record;
    made->folder = folder.empty() ? fs::path(".") : folder;
    made->introduce(name, record.says, "program");
    made->info.create = [&contender = *made](const Settings& settings) -> std::unique_ptr<const Method> {
        return std::make_unique<Program>(contender, settings);
    };
    return keep_outside(std::move(made));
}

IntroductionRecord introduction(const std::vector<std::string>& command, const fs::path& folder, double timeout_s) {
    IntroductionRecord says = ProgramSession(command, folder, timeout_s).says();
    try {
        check_introduction(says, "answer to hello");
    } catch (const InputError& e) {
        throw MethodError(e.what());
    }
    return says;
}

}  // namespace umbra
