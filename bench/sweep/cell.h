// Quality cells: what one setting gets wrong in one view of a scene. A cell depends on its key alone and is computed
// once.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "umbra/bench/compare/image_figures.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/bench/sweep/cell_record.h"

namespace umbra {

/// Runs with other seeds that tell noise from other errors in a cell. Fewer than `compare` takes: a sweep has many
/// cells.
inline constexpr int kCellNoiseRuns = 3;

/// What a cell's answers depend on besides the setting.
struct CellOptions {
    Size size{};
    std::optional<std::string> reference{};  ///< as typed; none: `default_reference`
    std::optional<std::uint64_t> points{};   ///< at which area lights are scored; none: as `run_reference` chooses
    Budget budget{};                         ///< of each cell, and of a reference that nobody names
    bool brief = false;  ///< without classes of errors, edges and memory: see needs_whole_cell(metric)
    std::function<void(const std::string&)> progress{};  ///< receives what takes long; may be empty
};

/// A method at work, and how long its build took, on all threads, where that is known.
struct BuiltWork {
    MethodAtWork work;
    std::optional<double> build_ms{};
};

/// A scene as loaded, and what its triangles decide, which all its views share. One caller at a time.
class OwnScene {
public:
    explicit OwnScene(Scene scene) : scene_(std::move(scene)) {}

    [[nodiscard]] const Scene& scene() const { return scene_; }
    /// Both are made when they are first asked for.
    [[nodiscard]] const SceneFacts& facts();
    [[nodiscard]] const RayScene& rays();

    /// What methods built for one view serves the others: they work on one scene, whose camera and lights are those of
    /// the view that turned to it last. Aims and looks of a view are valid again when it turns to it again.
    [[nodiscard]] std::uint64_t new_number() { return ++numbers_; }  ///< for a view that turns
    void turn_to(std::uint64_t number, const PreparedScene& view);
    /// After `turn_to`: a method at work there, with what was kept of the same build.
    [[nodiscard]] BuiltWork begin(const MethodChoice& choice) const;
    /// Of the references, and of the other methods, the last one is kept, without aims and looks.
    void keep(const MethodAtWork& work, std::optional<double> build_ms = {});

private:
    Scene scene_;
    std::optional<SceneFacts> facts_;
    std::optional<RayScene> rays_;
    std::uint64_t numbers_ = 0, turned_to_ = 0;
    std::optional<Scene> turned_;
    SceneFacts turned_facts_;
    std::optional<BuiltWork> reference_, other_;
};

/// One view of one scene, made ready when the first cell has to be computed.
class CellView {
public:
    /// View 0 is the scene itself. Only messages name `file`. The truth is kept in `folder` for other processes.
    CellView(std::shared_ptr<OwnScene> own, std::filesystem::path file, int view, CellOptions options,
             std::filesystem::path folder);

    [[nodiscard]] int view() const { return view_; }
    /// The key of a cell of this view, without making the view ready.
    [[nodiscard]] std::string key(const MethodChoice& choice, bool brief = false) const;
    /// Throws InputError, UsageError, and what a reference throws that cannot be replaced.
    [[nodiscard]] const PreparedScene& prepared();
    /// `reference` of the record: the truth of area.
    [[nodiscard]] ReferenceRecord reference();
    /// The key of that, without making the view ready.
    [[nodiscard]] std::string reference_key() const;

    /// A method that does not serve has a cell that says so, and one that throws has `failed`. Settings that follow one
    /// another and differ from a later phase on share the phases before. In view v > 0 methods that have a seed run with
    /// another one.
    [[nodiscard]] Cell compute(const MethodChoice& choice);
    /// Times of one run of all phases, alone: of the one that `compute` compared, or of one now, which the next `compute`
    /// of this setting compares; `anew`: of one now in any case. View 0. Nothing where the setting does not serve, or fails.
    /// Throws CutShort where the run takes longer than `seconds`, which are less than its budget.
    [[nodiscard]] std::optional<RunTimes> times_of_one_run(const MethodChoice& choice, bool anew = false,
                                                           double seconds = std::numeric_limits<double>::infinity());
    /// Whether neither the method nor the truth was cut short by a budget, which no key has, in the last computed cell.
    [[nodiscard]] bool is_whole() const { return is_whole_; }

private:
    /// Whether this method works where those of all views do.
    [[nodiscard]] bool shares(const MethodChoice& choice) const {
        return options_.brief && choice.info->outside.empty();
    }
    /// A method at work in this view, now.
    [[nodiscard]] BuiltWork begin(const MethodChoice& choice);
    [[nodiscard]] Truths& truths();
    [[nodiscard]] const Rendered& rendered(const Truth& truth);
    [[nodiscard]] std::string what_truth_depends_on() const;
    [[nodiscard]] MethodRun run(const MethodChoice& choice, std::optional<LightId>& at);
    void build(const MethodChoice& choice);
    [[nodiscard]] double time_of_build(const MethodChoice& choice);

    std::shared_ptr<OwnScene> own_;
    std::filesystem::path file_;
    int view_;
    CellOptions options_;
    std::filesystem::path folder_;
    std::string scene_key_;
    std::optional<PreparedScene> prepared_;
    std::uint64_t number_ = 0;  ///< of what is prepared
    std::optional<Truths> truths_;
    std::map<const Truth*, Rendered> rendered_;
    bool is_whole_ = true;
    std::shared_ptr<MethodAtWork> work_;     ///< of the method that was asked last
    std::optional<double> build_ms_;         ///< of what it has built, on all threads
    std::map<LightId, double> aim_ms_;       ///< of its aims
    double look_ms_ = 0;                     ///< of its look at the points
    std::optional<MethodRun> ran_;           ///< and nothing has compared it yet
    std::map<std::string, RunTimes> times_;  ///< of runs, by all settings, without `build`
};

}  // namespace umbra
