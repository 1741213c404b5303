#include "umbra/bench/contenders/program_session.h"

#include <fmt/format.h>

#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "umbra/bench/base/scene_files.h"
#include "umbra/bench/contenders/answers_file.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_writer.h"

namespace umbra {
namespace fs = std::filesystem;

Json hello_message(const fs::path& folder) {
    return {{"message", "hello"}, {"protocol", 1}, {"folder", folder.string()}};
}

Json scene_message(const fs::path& folder, const Scene& scene, const Json& settings) {
    write_scene_files(folder, scene);
    return {{"message", "scene"},
            {"scene", SceneExport::json},
            {"glb", SceneExport::glb},
            {"triangles", SceneExport::triangles},
            {"objects", SceneExport::object},
            {"blocks", SceneExport::blocks},
            {"settings", settings}};
}

Json build_message(const Json& settings) { return {{"message", "build"}, {"settings", settings}}; }

Json points_message(const fs::path& folder, const Scene& scene, const PointBatch& points, const Json& settings) {
    write_points(folder / "points.npy", scene, points);
    const Json raster = points.raster ? Json{points.raster->width, points.raster->height} : Json(nullptr);
    return {{"message", "points"}, {"points", "points.npy"}, {"raster", raster}, {"settings", settings}};
}

Json aim_message(const Scene& scene, LightId light, const Json& settings) {
    Light placed = scene.lights[light];
    placed.camera_pose.reset();  // where it is now, in world space
    return {{"message", "aim"},
            {"light", light},
            {"description", Json::parse(native_light_text(scene, placed))},
            {"settings", settings}};
}

Json visibility_message(const fs::path& folder, const PointBatch& points, LightId light, const Json& settings) {
    write_asked(folder / "asked.npy", points, light);
    return {{"message", "visibility"},
            {"light", light},
            {"asked", "asked.npy"},
            {"answers", "answers.npy"},
            {"settings", settings}};
}

namespace {

/// A program that cannot be served fails alone.
ScratchFolder folder_of_a_run() {
    try {
        return {};
    } catch (const InputError& e) {
        throw MethodError(e.what());
    }
}

fs::path made(const fs::path& folder) {
    fs::create_directory(folder);
    return folder;
}

/// The command with the folder of the run where it says {run}.
std::vector<std::string> placed(std::vector<std::string> command, const fs::path& run) {
    for (std::string& word : command) boost::replace_all(word, "{run}", run.string());
    return command;
}

}  // namespace

ProgramSession::ProgramSession(const std::vector<std::string>& command, const fs::path& where, double timeout_s)
    : folder_(folder_of_a_run()),
      timeout_s_(std::isnan(timeout_s) ? 120 : timeout_s),
      process_(placed(command, folder()), where, made(folder() / "temporary")) {
    try {
        says_ = from_record<IntroductionRecord>(ask(hello_message(folder())));
    } catch (const InputError& e) {
        throw MethodError(e.what());
    }
}

ProgramSession::~ProgramSession() {
    try {
        process_.tell(Json{{"message", "end"}}.dump());
    } catch (...) {  // it is ended all the same
    }
}

Field ProgramSession::ask(const Json& message) {
    const std::string kind = message["message"];
    const std::string text = process_.ask(message.dump(-1, ' ', false, Json::error_handler_t::replace), timeout_s_);
    Field answer;
    try {
        answer = parse_json(text, "answer to " + kind);
        if (!answer.is_object()) answer.refuse("an object");
        if (answer.has("error"))
            throw MethodError(
                fmt::format("the program answers \"{}\" with the error: {}", kind, answer["error"].text()));
    } catch (const InputError& e) {
        process_.fail(fmt::format("the program wrote {:?} to stdout, where one line of JSON is expected ({}).",
                                  text.substr(0, 200), e.what()));
    }
    return answer;
}

double ProgramSession::send(const Json& message, const std::function<void(const Field&)>& read) {
    const Field answer = ask(message);
    try {
        if (read) read(answer);
        const std::optional<double> ms = answer["ms"].number();
        if (ms && *ms < 0) answer["ms"].refuse("milliseconds, 0 or more");
        return ms.value_or(std::nan(""));
    } catch (const InputError& e) {
        process_.fail(e.what() + std::string("."));
    }
}

double ProgramSession::answers(const Json& message, const Scene& scene, const PointBatch& points, LightId light,
                               const Visibility& out) {
    const std::string expected = message["answers"];
    std::error_code ignored;
    fs::remove(folder() / expected, ignored);  // those of the call before are no answer
    return send(message, [&](const Field& answer) {
        const std::string named = answer["answers"].text();
        const fs::path file     = folder() / (named.empty() ? expected : named);
        if (named.find('/') != std::string::npos)
            process_.fail(fmt::format("the program names the file {}, expected one in its folder.", named));
        if (fs::symlink_status(file).type() != fs::file_type::regular)
            process_.fail(fmt::format("the program answered, but wrote no file {}.", named.empty() ? expected : named));
        read_answers(file, scene, points, light, true, out);
    });
}

}  // namespace umbra
