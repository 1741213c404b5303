#include "umbra/bench/contenders/contender.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "umbra/bench/base/files.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

/// S_j from a file: one a scene's raster.
class AnswersMethod final : public Method {
public:
    AnswersMethod(fs::path file, Measure measure) : file_(std::move(file)), measure_(measure) {}
    [[nodiscard]] Service serves(const SceneFacts&) const override {
        return {How::approximately, fmt::format("its answers are those of the file {}", file_.filename().string())};
    }
    [[nodiscard]] Measure measures() const override { return measure_; }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        read_answers(file_, aimed.scene(), looked.points, aimed.light, false, out);
    }

private:
    fs::path file_;
    Measure measure_;
};

struct AnswersFile final : OutsideMethod {
    fs::path file;
    [[nodiscard]] std::string text() const override { return summary + bytes_of(file); }
};

std::vector<fs::path> folders_of_contenders() {
    std::vector<fs::path> folders{"contenders"};
    const char* const config = std::getenv("XDG_CONFIG_HOME");
    const char* const home   = std::getenv("HOME");
    if (config != nullptr && *config != '\0')
        folders.push_back(fs::path(config) / "umbra/contenders");
    else if (home != nullptr && *home != '\0')
        folders.push_back(fs::path(home) / ".config/umbra/contenders");
    return folders;
}

}  // namespace

std::optional<fs::path> contender_file(const std::string& name) {
    if (fs::path(name).extension() == ".json" && fs::is_regular_file(name)) return name;
    for (const fs::path& folder : folders_of_contenders())
        if (const fs::path file = folder / (name + ".json"); fs::is_regular_file(file)) return file;
    return std::nullopt;
}

ContenderRecord read_contender(const fs::path& file) {
    if (!fs::is_regular_file(file)) throw InputError(fmt::format("{}: is no regular file", file.string()));
    constexpr std::uintmax_t most = 1u << 20;
    if (fs::file_size(file) > most) throw InputError(fmt::format("{}: has more than 1 MiB", file.string()));
    auto record = from_record<ContenderRecord>(parse_json(bytes_of(file), file.string()));
    if (record.command.empty()) throw InputError(fmt::format("{}: \"command\" is missing or empty", file.string()));
    if (record.timeout_s <= 0)
        throw InputError(fmt::format("{}: \"timeout_s\" is {}, expected more than 0", file.string(), record.timeout_s));
    check_introduction(record.says, file.string());
    return record;
}

std::vector<std::string> add_contenders() {
    std::vector<std::string> problems;
    for (const fs::path& folder : folders_of_contenders()) {
        std::error_code none;
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(folder, none))
            if (entry.path().extension() == ".json") files.push_back(entry.path());
        std::ranges::sort(files);
        for (const fs::path& file : files) {
            const std::string name = file.stem().string();
            if (std::ranges::any_of(methods(),
                                    [&](const MethodInfo* m) { return m->name == name && m->outside == "program"; }))
                continue;  // of the folder before
            try {
                const ContenderRecord record = read_contender(file);
                if (record.checked != record.says.version)
                    throw InputError(
                        fmt::format("{}: the program has not passed the gate, which writes this file: "
                                    "umbra contender check --save {} -- COMMAND",
                                    file.string(), name));
                add_method(program_method(name, record, fs::absolute(folder) / record.folder));
            } catch (const std::exception& e) {
                problems.emplace_back(e.what());
            }
        }
    }
    return problems;
}

const MethodInfo& answers_method(const NamedAnswers& given) {
    check_method_name(given.name);
    if (!fs::is_regular_file(given.where))
        throw InputError(fmt::format("{}: is not there, or is no regular file", given.where.string()));
    auto made         = std::make_unique<AnswersFile>();
    made->file        = given.where;
    made->name        = given.name;
    made->title       = fmt::format("{} (a file)", given.name);
    made->summary     = fmt::format("S_j as the file {} has it, of the share of {}. Not timed.",
                                    given.where.filename().string(), to_string(given.measure));
    made->info        = {.name         = made->name,
                         .title        = made->title,
                         .paper        = "Answers in a file, which were made elsewhere",
                         .summary      = made->summary,
                         .by_default   = false,
                         .needs_raster = true,
                         .outside      = "file of answers",
                         .is_timed     = false};
    made->info.create = [given](const Settings&) -> std::unique_ptr<const Method> {
        return std::make_unique<AnswersMethod>(given.where, given.measure);
    };
    return keep_outside(std::move(made));
}

MethodChoice add_answers(const std::string& text) {
    const MethodInfo& made = answers_method(parse_answers(text));
    add_method(made);
    return MethodChoice(made);
}

}  // namespace umbra
