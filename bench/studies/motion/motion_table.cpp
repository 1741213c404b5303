#include <fmt/format.h>

#include <cmath>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/motion/motion.h"
#include "umbra/bench/studies/motion/record_view.h"

namespace umbra {
namespace {

std::string noise_text(double bar) {
    if (!known(bar)) return "not ranked: without a control no two times differ";
    return fmt::format("{}times that differ by less than {:.0f} % are equal{}", is_too_noisy(bar) ? "not ranked: " : "",
                       std::ceil(100 * bar), is_too_noisy(bar) ? "; run it again when the machine is less busy" : "");
}

std::string winner_text(const std::optional<WinnerRecord>& winner, bool ranked) {
    if (!winner) return "none";
    if (!ranked) return "not ranked";
    std::string text = fmt::format("{} {} ms", winner->method, number_text(winner->ms));
    for (const std::string& tie : winner->ties) text += " = " + tie;
    if (winner->ties.empty() && winner->runner_up)
        text +=
            fmt::format(" (next: {}, x {})", *winner->runner_up, number_text(winner->runner_up_over_winner->median));
    return text;
}

std::string method_rows(const SceneMotionRecord& scene) {
    std::string text =
        fmt::format("  {:34} {:8} {:>10} {:>10} {:>8}  {:>17} {:>7} {:>10} {:>10} {:>10} {:>10}\n", "method", "moves",
                    "median ms", "model", "ratio", "interval", "holds", "mean rmse", "worst", "interior", "answered");
    for (const MovedMethodRecord& method : scene.methods) {
        if (!method.failed.empty())
            text += fmt::format("  {:34} failed: {}\n", method.text, method.failed);
        else if (method.movements.empty())
            text += fmt::format("  {:34} does not serve: {}\n", method.text, method.serves.why);
        for (const auto& [movement, m] : method.movements) {
            const RatioRecord& ratio = m.frame_over_model;
            text += fmt::format(
                "  {:34} {:8} {:>10} {:>10.2f} {:>8}  {:>8} {:>8} {:>7} {:>10} {:>10} {:>10} {:>10}\n", method.text,
                movement, number_text(m.median_ms), m.model_ms / static_cast<double>(m.frames.size()),
                number_text(ratio.median), number_text(ratio.interval[0]), number_text(ratio.interval[1]),
                coverage_text(ratio.coverage), number_text(m.mean_rmse, 4), number_text(m.worst_rmse, 4),
                m.interior ? std::to_string(*m.interior) : "-", m.answered() ? percent(m.answered()) + " %" : "-");
        }
    }
    return text;
}

}  // namespace

std::string motion_table(const MotionRecord& record) {
    std::string text;
    for (const SceneMotionRecord& scene : record.motion) {
        text += fmt::format("{}: {} triangles, {} x {}, {} frames a movement, no method updates incrementally\n",
                            scene.scene, scene.triangles, *scene.size.width, *scene.size.height, record.frames);
        for (const MovementRecord& movement : scene.movements)
            text += fmt::format("  {:8} {}\n", movement.movement,
                                movement.cannot.empty() ? movement.what : "cannot: " + movement.cannot);
        text += method_rows(scene);
        text += fmt::format(
            "  fastest by median of those that answer every point; the same with an RMSE of at most {:g} in every "
            "frame; {}\n",
            record.max_rmse, noise_text(scene.noise_bar));
        const bool ranked = !is_too_noisy(scene.noise_bar);
        for (const MixRecord& row : scene.winners)
            text += fmt::format("  {:28} {:60} | {}\n", row.mix, winner_text(row.complete, ranked),
                                winner_text(row.within, ranked));
        for (const BreakEvenRecord& pair : scene.break_even)
            text += fmt::format("  {} pays off over {} from {} on{}\n", pair.method, pair.over,
                                counted(pair.frames, "camera frame"),
                                pair.rounds[0] == pair.rounds[1]
                                    ? ""
                                    : fmt::format(" ({} to {} by the rounds)", number_text(pair.rounds[0], 0),
                                                  known(pair.rounds[1]) ? number_text(pair.rounds[1], 0) : "never"));
    }
    return text + machine_line(record.machine, record.load_average);
}

}  // namespace umbra
