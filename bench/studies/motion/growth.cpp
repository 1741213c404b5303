#include "umbra/bench/studies/motion/growth.h"

#include <fmt/format.h>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

std::vector<MethodChoice> methods_of(const GrowthCommand& command, const GrowthFamily& family) {
    std::vector<MethodChoice> chosen = chosen_methods(command.methods, command.choices, {});
    if (command.methods.empty() && command.choices.empty() && family.name == "pixels")
        for (const char* text : {"shadow_volumes:edges=silhouette", "shadow_volumes:edges=per_triangle"})
            chosen.push_back(parse_method(text));
    return chosen;
}

std::vector<const GrowthFamily*> chosen_families(const GrowthCommand& command) {
    std::vector<const GrowthFamily*> chosen;
    for (const std::string& name : command.over) chosen.push_back(&find_growth_family(name));
    if (chosen.empty())
        for (const GrowthFamily& family : growth_families()) chosen.push_back(&family);
    if (!command.most) return chosen;
    if (chosen.size() != 1)
        throw UsageError(
            fmt::format("--max {:g}: of which of {} sizes? Expected --over with one", *command.most, chosen.size()));
    const GrowthFamily& family = *chosen.front();
    if (*command.most < family.least || *command.most > family.limit)
        throw UsageError(fmt::format("--max {:g}: expected {:g} to {:g} {}", *command.most, family.least, family.limit,
                                     family.unit));
    return chosen;
}

}  // namespace

GrowthRecord measure_growth(const GrowthCommand& command) {
    const std::vector<const GrowthFamily*> families = chosen_families(command);
    static_cast<void>(chosen_methods(command.methods, command.choices, {}));  // what is typed is wrong now
    GrowthRecord record{.head         = head_record(command.command),
                        .budget       = budget_record(command.options.turns.most),
                        .machine      = machine_record(command.threads),
                        .load_average = {.before = load_average()}};
    for (const GrowthFamily* family : families) {
        const auto fail = [&](const std::string& method, const std::string& message) {
            record.failed.push_back(
                {.family = std::string(family->name), .method = method, .failure = {.message = message}});
        };
        try {
            const GrowthRun run =
                run_growth(*family, methods_of(command, *family), command.most.value_or(family->most), command.options);
            for (const GrowthSeries& series : run.series)
                if (series.left_out.starts_with("failed")) fail(series.choice.text(), series.left_out);
            record.growth.push_back(family_record(run));
        } catch (const UsageError&) {
            throw;
        } catch (const InputError&) {
            throw;
        } catch (...) {
            fail("the scene", current_message());
        }
    }
    if (record.growth.empty()) return record;
    record.load_average.after = load_average();
    StagedFiles staged;
    staged.write(command.out / "results.json", json_text(to_record(record)));
    write_growth_page(record, command.out, staged);
    staged.commit();
    return record;
}

}  // namespace umbra
