// A program from outside at work: the messages of docs/contenders.md.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/base/scratch_folder.h"
#include "umbra/bench/contenders/introduction.h"
#include "umbra/bench/contenders/line_process.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// The messages, each with the files that it names, which the functions write below `folder`.
[[nodiscard]] Json hello_message(const std::filesystem::path& folder);
[[nodiscard]] Json scene_message(const std::filesystem::path& folder, const Scene& scene, const Json& settings);
[[nodiscard]] Json build_message(const Json& settings);
[[nodiscard]] Json points_message(const std::filesystem::path& folder, const Scene& scene, const PointBatch& points,
                                  const Json& settings);
[[nodiscard]] Json aim_message(const Scene& scene, LightId light, const Json& settings);
[[nodiscard]] Json visibility_message(const std::filesystem::path& folder, const PointBatch& points, LightId light,
                                      const Json& settings);

/// One caller at a time.
class ProgramSession {
public:
    /// Starts the program in `where` and says hello. Every member throws MethodError where the program does not do as
    /// the protocol says; it is ended then.
    ProgramSession(const std::vector<std::string>& command, const std::filesystem::path& where, double timeout_s);
    ~ProgramSession();
    ProgramSession(const ProgramSession&)            = delete;
    ProgramSession& operator=(const ProgramSession&) = delete;

    [[nodiscard]] const IntroductionRecord& says() const { return says_; }  ///< its answer to `hello`
    [[nodiscard]] bool is_alive() const { return process_.is_alive(); }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

    /// What the program says it took, milliseconds; NaN where it says nothing. `read`, if given, takes its answer.
    double send(const Json& message, const std::function<void(const Field& answer)>& read = {});
    /// The same of `visibility`; reads the answers.
    double answers(const Json& message, const Scene& scene, const PointBatch& points, LightId light,
                   const Visibility& out);

    // What the program knows, so that it is told anew where that is something else.
    const void* looked = nullptr;
    const void* aimed  = nullptr;

private:
    [[nodiscard]] Field ask(const Json& message);

    ScratchFolder folder_;  // outlives the program
    double timeout_s_;
    LineProcess process_;
    IntroductionRecord says_;
};

}  // namespace umbra
