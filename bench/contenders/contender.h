// Contenders: methods from outside the program (docs/contenders.md). Each becomes a method as all others are.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/contenders/answers_file.h"
#include "umbra/bench/contenders/introduction.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// A program from outside, as a file of its own holds it: contenders/NAME.json.
struct ContenderRecord {
    std::vector<std::string> command{};
    std::string folder{};
    double timeout_s = kUnknown;
    std::string checked{};
    IntroductionRecord says{};
};
DESCRIBE(ContenderRecord) {
    of.name("contender", "a program from outside");
    of(MEMBER(command),
       "the program and its arguments; {run} in a word stands for the folder of files that is exchanged");
    of.may(MEMBER(folder), "where it is started, from the folder of this file; that folder itself");
    of.may(MEMBER(timeout_s), "seconds that an answer may take; 120 where it is not given");
    of.may(MEMBER(checked), "the version of the program that passed `umbra contender check`");
    of(MEMBER(says), "its own answer to `hello`");
}

/// A program as a method, called `name`, in a list of those that live as long as the process. Commands are started in
/// `folder`. Throws InputError where what it says cannot be a method.
[[nodiscard]] const MethodInfo& program_method(const std::string& name, const ContenderRecord& contender,
                                               const std::filesystem::path& folder);

/// The answers of a file as a method, in a list of those that live as long as the process. Throws InputError where there
/// is no such file, and UsageError where its name is none of a method.
[[nodiscard]] const MethodInfo& answers_method(const NamedAnswers& given);

/// Loads a shared library that exports umbra_contender() (include/umbra/contender.h) and makes a method of it, called as it
/// says. Throws InputError: the file, what was found, what is expected.
[[nodiscard]] const MethodInfo& library_method(const std::filesystem::path& file);

/// Starts the program and asks what it is. Throws MethodError.
[[nodiscard]] IntroductionRecord introduction(const std::vector<std::string>& command,
                                              const std::filesystem::path& folder, double timeout_s = kUnknown);

/// The file of a contender of that name, in the folders that add_contenders looks into, or itself where it is a .json
/// file; nothing where there is none.
[[nodiscard]] std::optional<std::filesystem::path> contender_file(const std::string& name);

/// Throws InputError.
[[nodiscard]] ContenderRecord read_contender(const std::filesystem::path& file);

/// Adds (add_method) what `contenders/*.json` of the working folder and of the user's configuration folder
/// ($XDG_CONFIG_HOME/umbra, ~/.config/umbra) describe; of two of one name the first. No program is started. Returns a
/// message for each file that cannot be read, which is left out.
[[nodiscard]] std::vector<std::string> add_contenders();

/// Adds the method of a shared library: one in C (library_method), or one of shadows/plugin.h. Throws InputError, and
/// UsageError where its name is taken.
void add_library_method(const std::filesystem::path& file);

/// "NAME=FILE" or "NAME=FILE:measure=irradiance": adds the answers of a file as a method and returns its choice. Throws
/// UsageError; the file is read when a scene is compared.
[[nodiscard]] MethodChoice add_answers(const std::string& text);

}  // namespace umbra
