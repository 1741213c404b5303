// A results.json with two lights and three methods, and a folder to make a report of it in.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "umbra/bench/base/field.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace report_fixture {

namespace fs = std::filesystem;
using nlohmann::json;

inline std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write(const fs::path& file, std::string_view content) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

inline std::vector<fs::path> files_below(const fs::path& folder, const std::string& ending) {
    std::vector<fs::path> files;
    if (!fs::exists(folder)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().extension() == ending) files.push_back(entry.path());
    return files;
}

inline std::vector<std::string> attributes(const std::string& html, const std::vector<std::string>& names) {
    std::vector<std::string> values;
    for (const std::string& name : names) {
        const std::string opening = " " + name + "=\"";
        for (auto at = html.find(opening); at != std::string::npos; at = html.find(opening, at)) {
            at += opening.size();
            values.push_back(html.substr(at, html.find('"', at) - at));
        }
    }
    return values;
}

/// The addresses that a page links to or shows; pictures inside the page itself have none.
inline std::vector<std::string> links(const std::string& html) {
    std::vector<std::string> found = attributes(html, {"href", "src"});
    std::erase_if(found, [](const std::string& link) { return link.starts_with("data:"); });
    return found;
}

inline std::string decoded(const std::string& url) {
    std::string text;
    for (std::size_t i = 0; i < url.size(); ++i) {
        if (url[i] != '%') {
            text += url[i];
            continue;
        }
        text += static_cast<char>(std::stoi(url.substr(i + 1, 2), nullptr, 16));
        i += 2;
    }
    return text;
}

inline json timing(double median) {
    return {{"median", median}, {"min", median * 0.9}, {"max", median * 1.2}, {"runs", 5}};
}

inline json method(const std::string& name, const std::vector<std::string>& lights) {
    json m = {{"id", name},
              {"name", name},
              {"title", "The " + name},
              {"paper", "A paper, 1978"},
              {"summary", "What it does."},
              {"text", name},
              {"parameters", {{"resolution", "512"}}},
              {"serves", {{"how", "approximately"}, {"why", "it has texels"}}},
              {"times", {{"build_ms", timing(4)}, {"aim_ms", timing(2)}, {"visibility_ms", timing(1)}}},
              {"memory_bytes", 1 << 20},
              {"coverage", 0.99996},
              {"image", {{"rmse", 0.01}, {"psnr", 40}, {"ssim", 0.99}, {"flip", 0.02}}},
              {"files", {{"exr", name + ".exr"}, {"png", name + ".png"}, {"flip", name + ".flip.png"}}}};
    for (const std::string& light : lights) {
        m["errors"].push_back(
            {{"light", light},
             {"points", 230400},
             {"undefined", 0},
             {"on_boundary", 3},
             {"lit", 200000},
             {"umbra", 30400},
             {"penumbra", 0},
             {"false_shadow", {{"interior", 12}, {"edge", 1034}, {"acne", nullptr}}},
             {"false_light", {{"interior", 0}, {"edge", 987}, {"detachment", nullptr}, {"leak", nullptr}}},
             {"mae", 0.008},
             {"rmse", 0.09},
             {"max", 1},
             {"bias", -0.0002},
             {"edge_displacement_px", nullptr}});
        m["light_times"].push_back({{"light", light}, {"aim_ms", timing(1)}, {"visibility_ms", timing(0.5)}});
        m["files"]["lights"][light] = {{"visibility", name + ".S." + light + ".png"},
                                       {"difference", name + ".diff." + light + ".png"}};
    }
    return m;
}

/// A whole results.json as `umbra compare` writes it: two lights, two methods that serve, one that does not.
inline json sample(const std::string& name) {
    const std::vector<std::string> lights = {"lamp", "blue sky #2"};
    json reference_lights;
    for (const std::string& light : lights) reference_lights[light] = {{"visibility", "reference.S." + light + ".png"}};
    json unserved = {{"id", "planar_projection"},
                     {"name", "planar_projection"},
                     {"title", "Planar projection"},
                     {"serves", {{"how", "not"}, {"why", "\"blue sky\" is an area light"}}}};
    return {{"schema", kResultsSchema},
            {"version", "0.1.0"},
            {"command", "umbra compare scenes/court.json -o results"},
            {"machine",
             {{"cpu", "A CPU"},
              {"cores", 2},
              {"threads", 2},
              {"memory_bytes", 1 << 30},
              {"system", "Debian"},
              {"compiler", "g++"}}},
            {"scene",
             {{"name", name},
              {"title", "The " + name},
              {"shows", "One sentence."},
              {"source", "scenes/court.json"},
              {"warnings", {"no camera: one was placed"}}}},
            {"facts",
             {{"triangles", 1234567},
              {"objects",
               {{{"name", "floor"},
                 {"triangles", 2},
                 {"vertices", 4},
                 {"boundary_edges", 4},
                 {"components", 1},
                 {"closed", false},
                 {"outward", false},
                 {"planar", true},
                 {"area", 4.0},
                 {"volume", 0}}}},
              {"planes", {{{"area", 4}}}},
              {"planar_area_share", 0.5},
              {"requires", {"point lights"}},
              {"not_required", {"transparency"}}}},
            {"size", {{"width", 640}, {"height", 360}}},
            {"lights",
             {{{"name", "lamp"}, {"kind", "point"}, {"place", "inside_view"}},
              {{"name", "blue sky #2"}, {"kind", "directional"}, {"place", "at_infinity"}}}},
            {"times", {{"load_ms", 1}, {"gbuffer_ms", 9}}},
            {"reference",
             {{"name", "ray_traced"},
              {"title", "Ray-traced"},
              {"text", "ray_traced:samples=1024"},
              {"exact", false},
              {"note", "It is sampled."},
              {"files", {{"exr", "reference.exr"}, {"png", "reference.png"}, {"lights", reference_lights}}}}},
            {"methods", {unserved, method("shadow_zbuffer", lights), method("ray_traced", lights)}}};
}

/// Every file name in a results.json: what is below `files`, except the names of the lights.
inline void each_file(const json& value, const std::function<void(const std::string&)>& visit) {
    if (value.is_string() && (value.get<std::string>().ends_with(".png") || value.get<std::string>().ends_with(".exr")))
        visit(value.get<std::string>());
    if (value.is_structured())
        for (const json& item : value) each_file(item, visit);
}

class Report : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder           = fs::temp_directory_path() /
                 ("umbra_report_test_" + std::string(test->name()) + "_" + std::to_string(::getpid()));
        fs::remove_all(folder);
        fs::create_directories(folder);
        out = folder / "results";
    }
    void TearDown() override { fs::remove_all(folder); }

    static void put(const fs::path& where, const json& results) {
        write(where / "results.json", results.dump());
        each_file(results, [&](const std::string& name) { write(where / name, "a picture"); });
    }
    void expect_refusal(const std::string& message_part) const {
        try {
            write_report({out}, out);
            ADD_FAILURE() << "not refused; expected: " << message_part;
        } catch (const InputError& error) {
            EXPECT_TRUE(contains(error.what(), message_part)) << error.what() << "\n  expected: " << message_part;
        }
        EXPECT_FALSE(fs::exists(out / "index.html"));
        EXPECT_TRUE(files_below(out, ".part").empty());
    }

    fs::path folder, out;
};

}  // namespace report_fixture
}  // namespace umbra
