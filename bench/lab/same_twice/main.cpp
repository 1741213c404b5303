// A/A control: every method is compared with itself, and a difference that is found is a false one. `./umbra bench
// --same` calls it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"

namespace {

using namespace umbra;

/// Of one kind of movement.
struct Count {
    int comparisons = 0, by_interval = 0, by_bar = 0, by_both = 0;

    void add(const std::vector<double>& a, const std::vector<double>& b, double bar) {
        const Ratio ratio = paired_ratio(a, b);
        const Ratio certain{ratio.median, {ratio.median, ratio.median}, ratio.pairs};
        ++comparisons;
        by_interval += differs(ratio, 0);
        by_bar += differs(certain, bar);
        by_both += differs(ratio, bar);
    }
};

std::vector<double> light_ms(const TurnTimes& t) {
    std::vector<double> all(t.aim.size());
    for (std::size_t r = 0; r < all.size(); ++r) all[r] = t.aim[r] + t.visibility[r];
    return all;
}

int run(int argc, char** argv) {
    CLI::App app("Compares every method with itself and counts the differences that are found: all of them are false.",
                 "same_twice");
    int wanted = 100, rounds = 7;
    std::filesystem::path scene;
    std::string size = "320x180";
    app.add_option("SCENE", scene, "a scene file")->required();
    app.add_option("--comparisons", wanted, "how many, at least")->check(CLI::Range(1, 1000000));
    app.add_option("--rounds", rounds, "of each comparison")->check(CLI::Range(1, 1000));
    app.add_option("--size", size, "of the picture");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 64;
    }
    const PreparedScene prepared = prepare_scene(scene, parse_size(size));
    std::vector<MethodChoice> choices;
    for (const MethodInfo* info : methods())
        if (info->by_default && verdict(*info->make(), prepared.facts))
            choices.insert(choices.end(), 2, MethodChoice(*info));

    const double load = load_average();
    std::array<Count, 3> counts;
    std::vector<double> bars, calibration;
    TurnOptions options;
    options.rounds       = rounds;
    options.budget_ms    = 1e12;
    options.share_builds = false;
    for (; counts[0].comparisons < wanted; ++options.seed) {
        const Turns turns = time_in_turns(prepared, choices, options);
        bars.push_back(turns.noise_bar);
        calibration.insert(calibration.end(), turns.calibration.begin(), turns.calibration.end());
        for (std::size_t k = 0; k < choices.size(); k += 2) {
            const TurnTimes &a = turns.settings[k], &b = turns.settings[k + 1];
            if (!a.failed.empty() || !b.failed.empty()) throw MethodError(a.choice.text() + ": " + a.failed + b.failed);
            counts[0].add(totals(a), totals(b), turns.noise_bar);
            counts[1].add(light_ms(a), light_ms(b), turns.noise_bar);
            counts[2].add(a.visibility, b.visibility, turns.noise_bar);
        }
    }
    fmt::print("{} methods of {}, {} rounds, {} threads, load average {:.2f} before and {:.2f} after\n",
               choices.size() / 2, prepared.scene.name, rounds, thread_count(), load, load_average());
    const auto [least, largest] = std::minmax_element(calibration.begin(), calibration.end());
    fmt::print("noise bar {:.1f} % in the median; calibration {:.1f} ms, from {:.1f} to {:.1f}\n", 100 * median(bars),
               median(calibration), *least, *largest);
    fmt::print(
        "\n| what moved | comparisons | interval excludes 1 | outside the bar | false difference: both |\n"
        "|---|--:|--:|--:|--:|\n");
    constexpr std::array names{"object", "light", "camera"};
    for (std::size_t m = 0; m < counts.size(); ++m) {
        const Count& c = counts[m];
        fmt::print("| {} | {} | {} | {} | {} ({:.1f} %) |\n", names[m], c.comparisons, c.by_interval, c.by_bar,
                   c.by_both, 100.0 * c.by_both / c.comparisons);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const umbra::InputError& e) {
        fmt::print(stderr, "same_twice: {}\n", e.what());
        return 4;
    } catch (const umbra::UsageError& e) {
        fmt::print(stderr, "same_twice: {}\n", e.what());
        return 64;
    } catch (const std::exception& e) {
        fmt::print(stderr, "same_twice: {}\n", e.what());
        return 5;
    }
}
