#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/view/view_server.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

struct ViewLine {
    std::string scene;
    bool open = false;
    ViewerOptions options;
};

int view(ViewLine line, const Common& common) {
    ViewerOptions& options = line.options;
    std::vector<std::string> scenes;
    if (!line.scene.empty()) scenes.push_back(line.scene);
    return_scenes(options.methods, scenes);
    if (scenes.size() != 1) throw UsageError("view: one SCENE is expected");
    options.scene = scene_file(scenes[0], common.up);
    if (options.methods.size() > 2)
        throw UsageError(fmt::format("--methods: {} methods, expected one or two", options.methods.size()));
    for (const std::string& method : options.methods) static_cast<void>(parse_method(method).make());
    if (options.methods.empty()) options.methods = {"shadow_zbuffer"};
    sigset_t end_signals{};  // kept from all threads that begin from here on, for one that waits for them
    sigemptyset(&end_signals);
    sigaddset(&end_signals, SIGINT);
    sigaddset(&end_signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &end_signals, nullptr);
    ViewServer server(options);
    print_out("{}\n", server.address());
    flush_out();
    if (!common.quiet) print_error("Ctrl-C ends it.\n");
    if (line.open && std::system(("xdg-open " + server.address() + " >/dev/null 2>&1 &").c_str()) != 0)
        print_error("no browser was opened: open the address by hand\n");
    std::atomic<bool> ended = false;
    const std::jthread ends([&] {
        int which = 0;
        sigwait(&end_signals, &which);
        server.stop();
        sigwait(&end_signals, &which);  // a second time, while a method still works: nobody waits for it
        if (!ended) std::_Exit(128 + SIGINT);
    });
    server.serve();
    ended = true;
    for (int k = 0; k < 2; ++k) kill(getpid(), SIGTERM);  // for the thread, which may wait yet
    return kDone;
}

}  // namespace

Action view_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<ViewLine>();
    add_scene(app, line->scene);
    add_methods(app, line->options.methods,
                "The method, or two to be seen beside each other (default: shadow_zbuffer)");
    app.add_option("--port", line->options.port, "Port on this machine (default: any that is free)")
        ->check(number_in(0, 65535, "an integer from 0 to 65535"))
        ->type_name("N");
    line->options.most.seconds = 20;
    add_budget(app, line->options.most);
    app.add_flag("--open", line->open, "Also open the address in the browser");
    return [line, &common] { return view(*line, common); };
}

}  // namespace umbra
