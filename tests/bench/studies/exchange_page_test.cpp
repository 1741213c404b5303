// `umbra radiosity`: its pictures, its record and its page of a room whose light is known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <set>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/radiosity/light_exchange.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// The eye in a closed room whose walls glow with 0.2 and reflect half of what arrives: everywhere I = 0.4.
PreparedScene glowing_room() {
    Scene scene;
    scene.name = "room", scene.title = "Room";
    scene.materials.resize(1);
    scene.materials[0].k_a = vec3(0), scene.materials[0].k_d = vec3(0.5f);
    scene.materials[0].emission = vec3(0.2f), scene.materials[0].two_sided = false;
    Mesh box = make_box({2, 2, 2});
    for (uvec3& t : box.triangles) std::swap(t[1], t[2]);
    add_object(scene, "room", box.positions, {}, box.triangles, 0);
    scene.camera.eye = {0.2f, 0.1f, 0.6f}, scene.camera.target = {0, 0, -1};
    scene.width = 48, scene.height = 32;
    return prepare_scene(std::move(scene), "room", {});
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(LightExchange, PicturesOfAGlowingRoomAreEven) {
    const TemporaryFolder folder;
    ExchangeOptions options;
    options.size = 0.15, options.steps = 100'000, options.until = 1e-4;
    const ExchangeRecord record = exchange_light(glowing_room(), options, folder.path());
    EXPECT_EQ(record.unshot.size(), record.steps + 1);
    EXPECT_EQ(record.unshot[0], 1);
    EXPECT_LE(record.unshot.back(), 1e-4);
    for (std::size_t k = 1; k < record.unshot.size(); ++k) ASSERT_LT(record.unshot[k], record.unshot[k - 1] + 1e-12);
    EXPECT_NEAR(record.arrived, 1, 0.02);
    for (const auto& [name, light] : {std::pair{"direct.png", 0.2f}, {"indirect.png", 0.2f}, {"both.png", 0.4f}}) {
        const Image picture = read_image(folder.path() / name).image;
        for (const float value : picture.data) ASSERT_NEAR(value, srgb_from_linear(light), 1.5 / 255) << name;
    }
    std::set<std::array<float, 3>> colours;
    const Image patches = read_image(folder.path() / "patches.png").image;
    for (std::size_t i = 0; i < patches.pixels(); ++i)
        colours.insert({patches.at(i, 0), patches.at(i, 1), patches.at(i, 2)});
    EXPECT_GT(colours.size(), 20u);
    // The patch that sent first is orange where it is seen; what is in its plane has no form factor.
    const Image factors = read_image(folder.path() / "form_factors.png").image;
    for (std::size_t i = 0; i < factors.pixels(); ++i) {
        const bool orange = factors.at(i, 0) == 1 && factors.at(i, 2) == 0;
        EXPECT_TRUE(orange || factors.at(i, 0) == factors.at(i, 2)) << i;
    }
}

TEST(LightExchange, PageShowsTheRecord) {
    const TemporaryFolder folder;
    ExchangeRecord record{.head    = {kResultsSchema, "1", "umbra radiosity"},
                          .patches = 1234,
                          .unshot  = {1.0, 0.1, 0.01},
                          .steps   = 2,
                          .arrived = 0.625};
    record.scene.title = "T", record.elements = {{"lamp", "elements_1.png"}};
    StagedFiles staged;
    write_study_page(exchange_report(record), record.head, folder.path(), staged);
    staged.commit();
    const std::string page = text_of(folder.path() / "index.html");
    EXPECT_NE(page.find(count(1234) + " patches, 2 steps, 1 % of the power unshot"), std::string::npos) << page;
    EXPECT_NE(page.find("62.5 % of what was sent arrived"), std::string::npos);
    EXPECT_NE(page.find("elements_1.png"), std::string::npos);
    // From the upper left corner to the lower right one: two decades over two steps.
    EXPECT_NE(page.find("d=\"M64.0 14.0L247.0 132.0L430.0 250.0\""), std::string::npos)
        << page.substr(page.find("class=\"line\""), 200);

    record.unshot = {1.0, 0.9996};
    StagedFiles again;
    write_study_page(exchange_report(record), record.head, folder.path(), again);
    again.commit();
    EXPECT_NE(text_of(folder.path() / "index.html").find("2 steps, 100 % of the power unshot"), std::string::npos);
}

}  // namespace
}  // namespace umbra
