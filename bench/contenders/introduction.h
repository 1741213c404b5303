// What a contender says of itself, and a method made of that.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// What a program says of itself (its answer to `hello`).
struct IntroductionRecord {
    std::string name{}, version{}, summary{}, measure{}, takes{}, seed{};
    std::vector<std::string> lights{};
    std::vector<ParameterRecord> parameters{};
};
DESCRIBE(IntroductionRecord) {
    of.name("introduction", "what a program from outside says of itself");
    of.must(MEMBER(name));
    of.must(MEMBER(version));
    of.may(MEMBER(summary), "one sentence");
    of.may(MEMBER(measure), "which share of an area light it answers", one_of({"area", "irradiance"}));
    of.may(MEMBER(takes), "any points, or whole pictures alone", one_of({"points", "raster"}));
    of.may(MEMBER(seed), "the parameter that seeds its noise");
    of(MEMBER(lights), "the kinds that it serves");
    MEMBERS(parameters);
}

/// Throws InputError where the members contradict the protocol; `from` names their source in messages.
void check_introduction(const IntroductionRecord& says, const std::string& from);

/// Letters, digits and underscores, no digit first: what a method's name may be. Throws UsageError.
void check_method_name(const std::string& name);

/// A method from outside and the texts that the views of `info` look into: stays at its place.
struct OutsideMethod {
    std::string name{}, title{}, paper{}, summary{};
    std::deque<std::string> texts{};  ///< of parameters
    MethodInfo info{};

    OutsideMethod()                                = default;
    virtual ~OutsideMethod()                       = default;
    OutsideMethod(const OutsideMethod&)            = delete;
    OutsideMethod& operator=(const OutsideMethod&) = delete;

    /// Everything that its answers depend on and that can be seen from here: what its file says, and the bytes of the
    /// files that its command names, of a script those of the scripts beside it, too (of a library or a file of
    /// answers: that file).
    [[nodiscard]] virtual std::string text() const = 0;
    /// Ends programs that wait for a question.
    virtual void end_idle() {}
    /// All of `info` but `create`; the title names `as` where another method has it. `kind` as in MethodInfo::outside.
    /// Throws InputError where what it says cannot be a method.
    void introduce(const std::string& as, const IntroductionRecord& says, const std::string& kind);
};

/// Takes it into the list of those that live as long as the process.
const MethodInfo& keep_outside(std::unique_ptr<OutsideMethod> method);

/// OutsideMethod::text; empty of all other methods.
[[nodiscard]] std::string text_of_outside(const MethodInfo& method);

/// Ends all programs that wait for a question.
void end_idle_programs();

/// Whether it serves the lights of a scene, by the kinds that it names.
[[nodiscard]] Service serves_by_kind(const IntroductionRecord& says, const std::string& kind, const SceneFacts& facts);

}  // namespace umbra
