// `umbra view`: which phases movements repeat, what placing does, and who is answered.
#include <gtest/gtest.h>
#include <httplib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"
#include "umbra/bench/view/view_server.h"
#include "umbra/bench/view/view_session.h"
#include "umbra/core/base/error.h"
#include "umbra/core/errors/error_causes.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

fs::path scene_file_of(const char* name) { return fs::path(UMBRA_SCENES) / (std::string(name) + ".json"); }

ViewRequest start_of(const Scene& scene, const char* method) {
    const auto numbers = [](vec3 v) { return std::vector<double>{v.x, v.y, v.z}; };
    return {.page    = "test",
            .width   = 96,
            .height  = 54,
            .eye     = numbers(scene.camera.eye),
            .target  = numbers(scene.camera.target),
            .methods = {method},
            .layer   = "visibility"};
}

/// "build aim look visibility" as the record of a side has them.
std::string repeated(const ViewReply& reply, std::size_t side = 0) {
    std::string names;
    for (const PhaseRecord& phase : reply.record.sides.at(side).phases)
        if (phase.repeated) names += (names.empty() ? "" : " ") + phase.phase;
    return names;
}

/// The reasons at pixels of a grid, those without a surface left out.
std::vector<WhyHereRecord> reasons(ViewSession& session, ViewRequest request, std::uint64_t dx, std::uint64_t dy) {
    std::vector<WhyHereRecord> all;
    for (std::uint64_t x = dx / 2; x < request.width; x += dx)
        for (std::uint64_t y = dy / 2; y < request.height; y += dy) {
            request.x = x, request.y = y;
            try {
                all.push_back(session.why(request, {}));
            } catch (const UsageError& e) {
                EXPECT_STREQ(e.what(), "no surface at this pixel");
            }
        }
    return all;
}

class View : public testing::Test {
protected:
    [[nodiscard]] ViewReply show() { return session_.show(request_, {}); }
    [[nodiscard]] PlacedLight light(LightId j) const {
        const Light& l = scene_.lights[j];
        return {j, {l.position.x, l.position.y, l.position.z}, {l.direction.x, l.direction.y, l.direction.z}, 1};
    }
    const Scene scene_   = load_scene(scene_file_of("six_lights"));
    ViewRequest request_ = start_of(scene_, "shadow_zbuffer:resolution=128");
    ViewSession session_{scene_file_of("six_lights")};
};

TEST_F(View, AMovementRepeatsThePhasesThatDependOnIt) {
    EXPECT_EQ(repeated(show()), "build aim look visibility");
    EXPECT_EQ(repeated(show()), "visibility") << "nothing has moved";
    request_.eye[0] += 0.25;
    EXPECT_EQ(repeated(show()), "look visibility");
    request_.lights = {light(2)};
    EXPECT_EQ(repeated(show()), "visibility") << "placed where it was";
    request_.lights[0].position[0] += 0.25;
    const ViewReply moved = show();
    EXPECT_EQ(repeated(moved), "aim visibility");
    EXPECT_EQ(moved.record.lights_moved, std::vector<std::string>{scene_.lights[2].name});
    request_.objects = {{scene_.objects.size() - 1, {0, 0.5, 0}, 30}};
    EXPECT_EQ(repeated(show()), "build aim look visibility");
    request_.methods[0] = "shadow_zbuffer:resolution=256";
    EXPECT_EQ(repeated(show()), "aim look visibility");
    request_.methods[0] = "shadow_zbuffer:bias=manual,resolution=256";
    EXPECT_EQ(repeated(show()), "visibility");
    request_.methods[0] = "planar_projection";
    EXPECT_EQ(repeated(show()), "build aim look visibility");
    request_.width = 80;
    EXPECT_EQ(repeated(show()), "look visibility");
}

/// What has been placed step by step is what a scene that begins there has.
TEST_F(View, PlacesAsIfTheSceneHadBegunThere) {
    static_cast<void>(show());
    request_.eye[1] += 1;
    static_cast<void>(show());
    request_.lights = {light(0)};
    request_.lights[0].position[0] += 0.5;
    request_.lights[0].position[1] = -2;  // below the floor, which faces away then
    const ViewReply light_moved    = show();
    ViewSession light_there(scene_file_of("six_lights"));
    EXPECT_EQ(light_there.show(request_, {}).pictures, light_moved.pictures);
    request_.objects             = {{scene_.objects.size() - 1, {0.25, 0, 0}, 0}};
    const ViewReply step_by_step = show();
    ViewSession other(scene_file_of("six_lights"));
    EXPECT_EQ(other.show(request_, {}).pictures, step_by_step.pictures);
    request_.eye         = start_of(scene_, "exact").eye, request_.lights.clear(), request_.objects.clear();
    const ViewReply back = show();
    ViewSession fresh(scene_file_of("six_lights"));
    EXPECT_EQ(fresh.show(request_, {}).pictures, back.pictures);
    EXPECT_NE(step_by_step.pictures, back.pictures);
}

TEST_F(View, ErrorsAreThoseOfTheTruth) {
    request_.methods      = {"exact"};
    request_.truth        = 1;
    const ViewReply right = show();
    ASSERT_TRUE(right.record.truth);
    EXPECT_TRUE(right.record.truth->exact);
    ASSERT_TRUE(right.record.sides[0].errors);
    EXPECT_EQ(right.record.sides[0].errors->wrong_interior, 0u);
    EXPECT_GT(right.record.sides[0].errors->points, 1000u);
    EXPECT_EQ(right.pictures.size(), 2u * 3 * 96 * 54) << "the truth beside it";
    // The same of the scene as it stands, by the classes of two planes alone.
    const PreparedScene prepared = prepare_scene(scene_file_of("six_lights"), {96, 54});
    const auto wrong_points      = [&](LightId light, ErrorClass which) {
        const auto plane = [&](const std::string& method) {
            return run_method(parse_method(method), prepared.scene, prepared.facts, prepared.points).planes[light];
        };
        ClassPlane classes = error_classes(prepared.points, light, plane(request_.methods[0]), plane("exact"),
                                                visibility_tolerance(scene_.lights[light].kind));
        mark_terminator(classes, prepared.scene, prepared.points, light);
        return points_of_class(classes, which).size();
    };
    request_.methods  = {"shadow_zbuffer:resolution=32,bias=manual,constant=6"};
    request_.light    = 5;
    const auto bright = wrong_points(5, ErrorClass::false_light);
    EXPECT_GT(bright, 3u);
    EXPECT_EQ(show().record.sides[0].errors->wrong_interior, bright + wrong_points(5, ErrorClass::false_shadow));
    request_.methods      = {"shadow_zbuffer:resolution=16,bias=manual"};
    request_.light        = 0;
    const ViewReply wrong = show();
    const auto acne       = wrong_points(0, ErrorClass::false_shadow);
    EXPECT_GT(acne, 20u);
    EXPECT_EQ(wrong.record.sides[0].errors->wrong_interior, acne + wrong_points(0, ErrorClass::false_light));
    EXPECT_GT(wrong.record.sides[0].errors->rmse, 0.05);
    EXPECT_TRUE(std::isnan(wrong.record.sides[0].errors->flip));
    std::vector<std::vector<std::uint8_t>> pictures{wrong.pictures};
    for (const char* layer : {"picture", "difference", "classes", "flip"}) {
        request_.layer        = layer;
        const ViewReply other = show();
        EXPECT_EQ(other.record.sides[0].layer, layer);
        EXPECT_EQ(std::ranges::count(pictures, other.pictures), 0) << layer;
        pictures.push_back(other.pictures);
    }
    EXPECT_GT(show().record.sides[0].errors->flip, 0.001);
    request_.layer  = "classes";
    request_.lights = {light(0)};
    request_.lights[0].position[0] += 0.5;
    request_.truth        = 0;
    const ViewReply moved = show();
    EXPECT_FALSE(moved.record.sides[0].errors) << "that truth was of another state";
    EXPECT_EQ(moved.record.sides[0].layer, "visibility");
}

TEST_F(View, SaysWhyAPointIsDark) {
    request_.methods = {"shadow_volumes"};
    std::size_t dark = 0, lit = 0;
    for (const WhyHereRecord& why : reasons(session_, request_, 6, 3)) {
        if (!why.decided.empty()) continue;
        ASSERT_EQ(why.answers.size(), 2u) << "the method and the reference";
        const bool is_dark = why.answers[0].answer.verdict == "umbra";
        ++(is_dark ? dark : lit);
        EXPECT_EQ(why.answers[0].answer.verdict, why.answers[1].answer.verdict);
        EXPECT_EQ(why.answers[1].blocker_corners.size(), is_dark ? 3u : 0u);
        EXPECT_NE(why.answers[0].sentence.find("S "), std::string::npos);
    }
    EXPECT_GT(lit, 10u);
    EXPECT_GT(dark, 3u);
}

TEST(ViewOfAnAreaLight, ShowsWhatThePointSeesOfIt) {
    const Scene scene = load_scene(scene_file_of("umbra_penumbra"));
    ViewSession session(scene_file_of("umbra_penumbra"));
    std::size_t judged = 0, penumbra = 0;
    for (const WhyHereRecord& why : reasons(session, start_of(scene, "ray_traced"), 6, 5)) {
        if (!why.decided.empty()) continue;
        ASSERT_TRUE(why.seen);
        ASSERT_EQ(why.seen->cells.size(), why.seen->side * why.seen->side);
        const float exact = why.answers[1].answer.visibility.value();
        EXPECT_NEAR(why.seen->fraction, exact, 0.04);
        ++judged;
        penumbra += exact > 0.1f && exact < 0.9f;
    }
    EXPECT_GT(judged, 50u);
    EXPECT_GT(penumbra, 5u);
}

/// A lamp around the camera's target: whatever lies there is lit, and methods are not asked.
TEST_F(View, PointsInASphereLightAreDecided) {
    const Scene scene = load_scene(scene_file_of("light_sizes"));
    ViewSession session(scene_file_of("light_sizes"));
    ViewRequest request = start_of(scene, "ray_traced");
    request.truth       = 1;
    const Light& lamp   = scene.lights[2];
    ASSERT_EQ(lamp.kind, LightKind::sphere);
    request.light         = 2;
    request.lights        = {{2, request.target, {0, -1, 0}, 4}};
    const ViewReply shown = session.show(request, {});
    EXPECT_EQ(shown.record.sides[0].failed, "");
    std::size_t within = 0;
    for (const WhyHereRecord& why : reasons(session, request, 15, 8))
        within += why.decided.starts_with("The point lies in the light");
    EXPECT_GT(within, 0u);
}

TEST_F(View, KeepsTheSceneAsItIsNow) {
    request_.lights             = {light(1)};
    request_.lights[0].position = {1, 2.5, 3};
    static_cast<void>(show());
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "now.json") << session_.scene_text();
    const Scene now = load_scene(folder.path() / "now.json");
    EXPECT_EQ(now.lights[1].position, vec3(1, 2.5f, 3));
    EXPECT_EQ(now.triangles.size(), scene_.triangles.size());
}

TEST_F(View, ReadsAFileAgainThatHasChanged) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "scene.json";
    fs::copy_file(scene_file_of("sun_on_plane"), file);
    ViewSession session(file);
    request_               = start_of(load_scene(file), "shadow_volumes");
    const ViewReply before = session.show(request_, {});
    fs::copy_file(scene_file_of("six_lights"), file, fs::copy_options::overwrite_existing);
    fs::last_write_time(file, fs::last_write_time(file) + std::chrono::seconds(5));
    const ViewReply after = session.show(request_, {});
    EXPECT_EQ(repeated(after), "build aim look visibility");
    EXPECT_NE(before.pictures, after.pictures);
    // Fewer lights than the page has placed.
    const Light& last = scene_.lights[5];
    request_.light    = 5;
    request_.lights   = {{5, {last.position.x, 9, last.position.z}, {0, -1, 0}, 1}};
    request_.objects  = {{scene_.objects.size() - 1, {0, 1, 0}, 0}};
    EXPECT_EQ(repeated(session.show(request_, {})), "build aim look visibility");
    fs::copy_file(scene_file_of("sun_on_plane"), file, fs::copy_options::overwrite_existing);
    fs::last_write_time(file, fs::last_write_time(file) + std::chrono::seconds(7));
    EXPECT_THROW((void)session.show(request_, {}), UsageError);
    request_.light = 0, request_.lights.clear(), request_.objects.clear();
    EXPECT_EQ(session.show(request_, {}).pictures, before.pictures);
    std::ofstream(file) << "{";
    fs::last_write_time(file, fs::last_write_time(file) + std::chrono::seconds(9));
    EXPECT_THROW((void)session.show(request_, {}), InputError);
}

TEST_F(View, RefusesWhatThereIsNot) {
    const auto refused = [&](const auto& change) {
        ViewRequest wrong = request_;
        change(wrong);
        EXPECT_THROW((void)session_.show(wrong, {}), UsageError);
    };
    refused([](ViewRequest& r) { r.methods = {"nobody"}; });
    refused([](ViewRequest& r) { r.methods = {"shadow_zbuffer:resolution=1"}; });
    refused([](ViewRequest& r) { r.light = 99; });
    refused([](ViewRequest& r) { r.lights = {{99, {0, 0, 0}, {0, 0, 1}, 1}}; });
    refused([](ViewRequest& r) { r.objects = {{99, {0, 0, 0}, 0}}; });
    refused([](ViewRequest& r) { r.eye = r.target; });
    refused([](ViewRequest& r) { r.frame = 3; });
    EXPECT_EQ(repeated(show()), "build aim look visibility") << "and goes on";
    EXPECT_EQ(show().record.sides[0].failed, "");
}

TEST(ViewRequests, AreReadWithCare) {
    const std::string good =
        R"({"page":"a","width":64,"height":36,"frame":0,"eye":[0,1,5],"target":[0,0,0],"lights":[],"objects":[],)"
        R"("methods":["exact"],"light":0,"layer":"picture","truth":0})";
    EXPECT_EQ(view_request(good).methods[0], "exact");
    const auto refused = [&](const std::string& from, const std::string& to) {
        std::string wrong = good;
        wrong.replace(wrong.find(from), from.size(), to);
        EXPECT_ANY_THROW((void)view_request(wrong)) << wrong;
    };
    refused("\"a\"", "\"\"");
    refused("64", "8");
    refused("64", "1e9");
    refused("[0,1,5]", "[0,1]");
    refused("[0,1,5]", "[0,1,1e300]");
    refused("[0,1,5]", "[0,1,\"x\"]");
    refused("[\"exact\"]", "[]");
    refused("[\"exact\"]", "[\"exact\",\"exact\",\"exact\"]");
    refused("picture", "../../etc/passwd");
    refused("\"truth\":0", "\"truth\":7");
    refused("}", "");
    // Numbers that are left out are none.
    refused("\"width\":64,", "");
    refused("\"height\":36,", "");
    refused("\"objects\":[]", R"("objects":[{"object":0,"move":[0,0,0]}])");
    refused("\"lights\":[]", R"("lights":[{"light":0,"position":[0,0,0],"direction":[0,1,0]}])");
    refused("\"width\":64,\"height\":36", "\"width\":1900,\"height\":1900");
}

class Served : public testing::Test {
protected:
    Served() : server_({.scene = scene_file_of("sun_on_plane"), .methods = {"shadow_volumes"}}) {
        const std::string address = server_.address();
        const auto slash          = address.find('/', 7);
        host_                     = address.substr(0, slash);
        root_                     = address.substr(slash);
        thread_                   = std::thread([&] { server_.serve(); });
    }
    ~Served() override {
        server_.stop();
        thread_.join();
    }
    [[nodiscard]] int status(const std::string& path, const httplib::Headers& headers = {}) {
        httplib::Client client(host_);
        const auto answer = client.Get(path, headers);
        return answer ? answer->status : -1;
    }
    [[nodiscard]] int post(const std::string& path, const std::string& body) {
        httplib::Client client(host_);
        client.set_read_timeout(60);
        const auto answer = client.Post(path, body, "application/json");
        return answer ? answer->status : -static_cast<int>(answer.error());
    }
    [[nodiscard]] std::string good(const char* page = "p") const {
        return R"({"page":")" + std::string(page) +
               R"(","width":64,"height":36,"frame":0,"eye":[4,4,9],"target":[0,0,0],"lights":[],"objects":[],)"
               R"("methods":["shadow_volumes"],"light":0,"layer":"picture","truth":1})";
    }
    ViewServer server_;
    std::string host_, root_;
    std::thread thread_;
};

TEST_F(Served, AnswersOnlyItsAddress) {
    for (const char* name : {"", "view.js", "view.css", "report.css", "scene.json"})
        EXPECT_EQ(status(root_ + name), 200) << name;
    for (const char* name : {"../../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "nothing"})
        EXPECT_GE(status(root_ + name), 400) << name;
    EXPECT_EQ(status("/"), 403);
    EXPECT_EQ(status("/00000000000000000000000000000000/"), 403) << "another word";
    EXPECT_EQ(status(root_, {{"Host", "evil.example"}}), 403) << "a name that leads here";
    EXPECT_EQ(status(root_, {{"Origin", "http://evil.example"}}), 403) << "another site's page";
    EXPECT_EQ(status(root_, {{"Origin", host_}}), 200);
}

TEST_F(Served, SendsRecordAndPictures) {
    httplib::Client client(host_);
    const auto answer = client.Post(root_ + "show", good(), "application/json");
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->status, 200) << answer->body;
    std::uint32_t length = 0;
    for (unsigned k = 0; k < 4; ++k) length |= std::uint32_t(std::uint8_t(answer->body[k])) << (8 * k);
    const nlohmann::json record = nlohmann::json::parse(answer->body.substr(4, length));
    EXPECT_EQ(record["sides"][0]["method"], "shadow_volumes");
    EXPECT_EQ(answer->body.size(), 4 + length + 2u * 3 * 64 * 36);
}

TEST_F(Served, OutlivesWrongRequests) {
    EXPECT_EQ(post(root_ + "show", ""), 422);
    EXPECT_EQ(post(root_ + "show", "[]"), 422);
    EXPECT_EQ(post(root_ + "why", good()), 400) << "no pixel";
    EXPECT_EQ(post(root_ + "show", std::string(10 << 20, 'x')), 413);
    std::uint64_t random = 7;
    const auto next = [&] { return random = random * 6364136223846793005ULL + 1442695040888963407ULL, random >> 33; };
    for (int k = 0; k < 300; ++k) {
        std::string wrong = good();
        for (int change = 0; change < 3; ++change) wrong[next() % wrong.size()] = static_cast<char>(32 + next() % 95);
        const int answer = post(root_ + (k % 3 == 0 ? "why" : "show"), wrong);
        EXPECT_TRUE(answer == 200 || answer == 400 || answer == 422) << answer << ' ' << wrong;
    }
    std::vector<std::thread> many;
    std::atomic<int> answered = 0;
    for (int k = 0; k < 200; ++k)
        many.emplace_back([&, k] {
            const int answer = post(root_ + "show", good(k % 2 ? "one" : "two"));
            answered += answer == 200 || answer == 409;
        });
    for (std::thread& one : many) one.join();
    EXPECT_EQ(answered, 200);
    EXPECT_EQ(post(root_ + "show", good()), 200);
}

}  // namespace
}  // namespace umbra
