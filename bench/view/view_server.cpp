#include "umbra/bench/view/view_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <functional>
#include <list>
#include <mutex>
#include <random>
#include <utility>

#include "report_assets.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/view/view_session.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

constexpr std::size_t kMostBytes = 256 * 1024;  // of a request: ten thousand placed objects are far less

/// 128 random bits.
std::string random_word() {
    std::random_device random;
    std::string word;
    for (int k = 0; k < 4; ++k) word += fmt::format("{:08x}", static_cast<std::uint32_t>(random()));
    return word;
}

/// Little-endian length of the record, the record, the pictures.
std::string packed(const ViewReply& reply) {
    const std::string record = json_text(to_record(reply.record));
    std::string body;
    for (unsigned k = 0; k < 4; ++k) body += static_cast<char>(record.size() >> (8 * k) & 0xff);
    body += record;
    body.append(reinterpret_cast<const char*>(reply.pictures.data()), reply.pictures.size());
    return body;
}

void answer_text(httplib::Response& response, int status, const std::string& text) {
    response.status = status;
    response.set_content(text + "\n", "text/plain; charset=utf-8");
}

}  // namespace

struct ViewServer::Pages {
    /// httplib listens to five connections at a time that wait to be accepted, and drops others.
    struct ListeningServer : httplib::Server {
        void widen() const { ::listen(svr_sock_, SOMAXCONN); }
    };

    explicit Pages(const ViewerOptions& with) : options(with), word(random_word()) {}

    struct Page {
        std::string name;
        std::mutex busy;
        std::unique_ptr<ViewSession> session;  ///< null until it is first needed
    };

    /// The page of this name, as the last that asked.
    std::shared_ptr<Page> find(const std::string& name) {
        const std::lock_guard lock(mutex);
        const auto there = std::ranges::find(open, name, [](const auto& page) { return page->name; });
        if (there != open.end()) {
            open.splice(open.begin(), open, there);
            return open.front();
        }
        auto page  = std::make_shared<Page>();
        page->name = name;
        if (spare) page->session = std::move(spare);
        open.push_front(page);
        if (open.size() > options.pages) open.pop_back();
        return page;
    }

    using Answer = std::function<std::string(ViewSession&, const ViewRequest&)>;

    /// Writes what `answer` returns, or an error where it throws.
    void handle(const httplib::Request& request, httplib::Response& response, const char* type, const Answer& answer) {
        try {
            const ViewRequest wanted         = view_request(request.body);
            const std::shared_ptr<Page> page = find(wanted.page);
            const std::unique_lock lock(page->busy, std::try_to_lock);
            if (!lock) return answer_text(response, 409, "the page's last request is still being answered");
            if (!page->session) page->session = std::make_unique<ViewSession>(options.scene);
            response.set_content(answer(*page->session, wanted), type);
        } catch (const UsageError& e) {
            answer_text(response, 400, e.what());
        } catch (const InputError& e) {
            answer_text(response, 422, e.what());
        } catch (...) {
            answer_text(response, 500, current_message());
        }
    }

    /// Refuses what does not come from this machine's browser, opened by the address.
    [[nodiscard]] httplib::Server::HandlerResponse check(const httplib::Request& request,
                                                         httplib::Response& response) const {
        response.set_header("Cache-Control", "no-store");
        response.set_header("X-Content-Type-Options", "nosniff");
        response.set_header("Referrer-Policy", "no-referrer");
        response.set_header("Content-Security-Policy",
                            "default-src 'self'; img-src 'self' data: blob:; frame-ancestors 'none'; "
                            "form-action 'none'; base-uri 'none'");
        const std::string host = request.get_header_value("Host"), here = fmt::format("127.0.0.1:{}", port),
                          local  = fmt::format("localhost:{}", port);
        const std::string origin = request.get_header_value("Origin");
        const bool is_host       = host == here || host == local;
        const bool is_origin     = origin.empty() || origin == "http://" + host;
        if (is_host && is_origin && request.path.starts_with("/" + word + "/"))
            return httplib::Server::HandlerResponse::Unhandled;
        answer_text(response, 403, "not the address that umbra view has printed");
        return httplib::Server::HandlerResponse::Handled;
    }

    /// `scene`: the record of the scene as its file has it.
    void add_routes(const ViewedSceneRecord& scene) {
        const std::string root = "/" + word + "/";
        server.set_payload_max_length(kMostBytes);
        server.set_tcp_nodelay(true);  // the body of a short answer would wait 40 ms for the head to be acknowledged
        server.set_read_timeout(5);
        server.set_write_timeout(5);
        server.set_keep_alive_timeout(5);
        server.new_task_queue = [] { return new httplib::ThreadPool(8); };
        server.set_pre_routing_handler(
            [this](const httplib::Request& request, httplib::Response& response) { return check(request, response); });
        const auto get = [&](const char* name, std::string_view content, const char* type) {
            server.Get(root + name,
                       [content = std::string(content), type](const httplib::Request&, httplib::Response& response) {
                           response.set_content(content, type);
                       });
        };
        const PageHead head{"Umbra view: " + scene_name(options.scene), {"view.js"}};
        get("", render_page(assets::view_html, head, {{"scene", scene_name(options.scene)}}),
            "text/html; charset=utf-8");
        get("report.css", assets::report_css, "text/css; charset=utf-8");
        get("view.css", assets::view_css, "text/css; charset=utf-8");
        get("view.js", assets::view_js, "text/javascript; charset=utf-8");
        get("scene.json", json_text(to_record(scene)), "application/json");
        const auto post = [&](const char* name, const char* type, Answer answer) {
            server.Post(root + name, [this, type, answer = std::move(answer)](const httplib::Request& request,
                                                                              httplib::Response& response) {
                handle(request, response, type, answer);
            });
        };
        post("show", "application/octet-stream", [this](ViewSession& session, const ViewRequest& wanted) {
            return packed(session.show(wanted, options.most));
        });
        post("why", "application/json", [this](ViewSession& session, const ViewRequest& wanted) {
            return json_text(to_record(session.why(wanted, options.most)));
        });
        post("file", "application/json", [this](ViewSession& session, const ViewRequest& wanted) {
            static_cast<void>(session.show(wanted, options.most));
            return session.scene_text();
        });
    }

    ViewerOptions options;
    std::string word;
    int port = 0;
    ListeningServer server;
    std::mutex mutex;                       ///< of the next two
    std::list<std::shared_ptr<Page>> open;  ///< the last that asked first
    std::unique_ptr<ViewSession> spare;     ///< loaded ahead, for the first page
};

ViewServer::ViewServer(const ViewerOptions& options) : pages_(std::make_unique<Pages>(options)) {
    Pages& p                 = *pages_;
    p.spare                  = std::make_unique<ViewSession>(options.scene);
    ViewedSceneRecord record = p.spare->scene_record();
    record.chosen            = options.methods;
    record.command           = "umbra compare " + options.scene.string() + " --methods";
    for (const std::string& method : options.methods) record.command += " " + method;
    p.add_routes(record);
    const bool any = options.port == 0;
    p.port         = any ? p.server.bind_to_any_port("127.0.0.1") : options.port;
    if (p.port <= 0 || (!any && !p.server.bind_to_port("127.0.0.1", options.port)))
        throw UsageError(fmt::format("port {}: cannot be listened on, expected one that is free", options.port));
    p.server.widen();
}

ViewServer::~ViewServer() { stop(); }

std::string ViewServer::address() const { return fmt::format("http://127.0.0.1:{}/{}/", pages_->port, pages_->word); }
void ViewServer::serve() { pages_->server.listen_after_bind(); }
void ViewServer::stop() { pages_->server.stop(); }

}  // namespace umbra
