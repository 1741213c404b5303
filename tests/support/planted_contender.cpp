// A contender for tests (docs/contenders.md): planted_contender FAULT, right where FAULT is "none", and else wrong in
// one way that programs from outside are wrong in. Point, directional and rectangle lights.
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace {

using nlohmann::json;

struct Vec {
    double x, y, z;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec vec(const json& j) { return {j[0], j[1], j[2]}; }

#pragma pack(push, 1)
struct Point {
    Vec position;
    float normal[3];
    std::uint32_t triangle;
    float u, v;
    std::int32_t column, row;
};
#pragma pack(pop)

/// The items of a .npy file, whose type the caller knows.
template <class T>
std::vector<T> array(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::string all((std::istreambuf_iterator<char>(in)), {});
    const std::size_t begin = 10 + static_cast<unsigned char>(all.at(8)) + 256u * static_cast<unsigned char>(all.at(9));
    std::vector<T> items((all.size() - begin) / sizeof(T));
    std::memcpy(items.data(), all.data() + begin, items.size() * sizeof(T));
    return items;
}

void write(const std::string& file, const std::vector<float>& values, const std::string& shape) {
    std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': " + shape + ", }";
    header.resize((10 + header.size() + 1 + 63) / 64 * 64 - 10 - 1, ' ');
    header += '\n';
    std::ofstream out(file, std::ios::binary);
    out << "\x93NUMPY" << '\x01' << '\0' << static_cast<char>(header.size() % 256)
        << static_cast<char>(header.size() / 256) << header;
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(float)));
}

struct World {
    std::string folder, fault;
    std::vector<std::array<float, 9>> triangles{};
    std::vector<std::uint8_t> blocks{};
    std::vector<Point> points{};
    std::vector<std::size_t> raster{};
    json light{}, light_before{};
    int asked = 0;

    [[nodiscard]] bool is_blocked(const Point& at, Vec way) const {
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            if (blocks[t] == 0) continue;
            const auto& x = triangles[t];
            const Vec a{x[0], x[1], x[2]}, b{x[3], x[4], x[5]}, c{x[6], x[7], x[8]};
            const Vec n = cross(b - a, c - a), q = cross(way, at.position - a);
            const double slope = -dot(n, way), h = dot(n, at.position - a) / slope, u = -dot(c - a, q) / slope,
                         v = dot(b - a, q) / slope;
            if (fault == "self_shadow" && at.triangle == t) return true;
            if (t != at.triangle && slope != 0 && h > 1e-9 && h < 1 && u >= 0 && v >= 0 && u + v <= 1) return true;
        }
        return false;
    }

    [[nodiscard]] double seen(const Point& at, const json& of) const {
        if (of["type"] == "directional") return is_blocked(at, -1e6 * vec(of["direction"])) ? 0 : 1;
        if (of["type"] == "point") return is_blocked(at, vec(of["position"]) - at.position) ? 0 : 1;
        constexpr int kSide = 8;
        const Vec edge_u = vec(of["edge_u"]), edge_v = vec(of["edge_v"]);
        const Vec face = cross(edge_u, edge_v), normal{at.normal[0], at.normal[1], at.normal[2]};
        double sum = 0, all = 0;
        for (int k = 0; k < kSide * kSide; ++k) {
            const int column = k % kSide, row = k / kSide;
            const Vec to = vec(of["position"]) + ((column + 0.5) / kSide - 0.5) * edge_u +
                           ((row + 0.5) / kSide - 0.5) * edge_v - at.position;
            const double front = dot(normal, to), d = dot(to, to);
            const double weight = fault == "irradiance" ? std::max(front, 0.0) * std::abs(dot(face, to)) / (d * d) : 1;
            all += weight;
            if (front > 0 && !is_blocked(at, to)) sum += weight;
        }
        return all > 0 ? sum / all : 0;
    }

    std::vector<float> answers() {
        std::vector<float> s(points.size(), 0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Point& at = points[i];
            if (at.triangle == 0xffffffffu) continue;
            double value = seen(at, fault == "other_light" && !light_before.is_null() ? light_before : light);
            if (fault == "both_lights" && !light_before.is_null()) value = (value + seen(at, light_before)) / 2;
            if (fault == "lit") value = 1;
            if (fault == "exchanged") value = 1 - value;
            if (fault == "srgb") value = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
            if (fault == "random" && value > 0) value *= 1 - 1e-6 * asked;
            if (fault == "nan" && at.column % 4 != 0) value = std::nan("");
            if (fault == "silent") value = std::nan("");
            if (fault == "beyond") value *= 2;
            s[i] = static_cast<float>(value);
        }
        const auto turned = [&](auto from) {
            std::vector<float> t(s.size(), 0);
            if (!raster.empty())
                for (std::size_t i = 0; i < s.size(); ++i) t[i] = s[from(i % raster[0], i / raster[0])];
            s = raster.empty() ? s : t;
        };
        const std::size_t w = raster.empty() ? 0 : raster[0], h = raster.empty() ? 0 : raster[1];
        if (fault == "upside_down") turned([&](std::size_t x, std::size_t y) { return (h - 1 - y) * w + x; });
        if (fault == "mirrored") turned([&](std::size_t x, std::size_t y) { return y * w + w - 1 - x; });
        if (fault == "beside") turned([&](std::size_t x, std::size_t y) { return y * w + std::min(x + 1, w - 1); });
        if (fault == "first_points" && raster.empty()) std::reverse(s.begin(), s.end());
        if (fault == "few") s.resize(s.size() / 2);
        return s;
    }

    json answer(const json& message) {
        const std::string kind = message["message"];
        if (kind == "hello") {
            folder = message["folder"].get<std::string>() + "/";
            json says{{"name", "Planted"},
                      {"version", "1"},
                      {"measure", "area"},
                      {"takes", "points"},
                      {"lights", {"point", "directional", "rectangle"}}};
            if (fault == "two_lines") says["version"] = "1\n2";
            if (fault == "no_measure") says.erase("measure");
            if (fault == "no_lights") says["lights"] = json::array();
            if (fault == "raster" || fault == "upside_down" || fault == "mirrored" || fault == "beside")
                says["takes"] = "raster";
            return says;
        }
        if (kind == "scene") {
            if (fault == "keeps_the_scene" && !triangles.empty()) return json::object();
            triangles    = array<std::array<float, 9>>(folder + message["triangles"].get<std::string>());
            blocks       = array<std::uint8_t>(folder + message["blocks"].get<std::string>());
            light_before = light = nullptr;
            return json::object();
        }
        if (kind == "points") {
            points = array<Point>(folder + message["points"].get<std::string>());
            raster = message["raster"].is_null() ? std::vector<std::size_t>{}
                                                 : message["raster"].get<std::vector<std::size_t>>();
        }
        if (kind == "aim") light_before = light, light = message["description"];
        if (kind == "visibility") {
            ++asked;
            if (fault == "hangs") std::this_thread::sleep_for(std::chrono::seconds(3600));
            if (fault == "crashes") std::cerr << "out of luck\n", std::abort();
            if (fault == "ends") std::cerr << "bye\n", std::exit(3);
            if (fault == "error") return {{"error", "no such light here"}};
            if (fault == "no_file") return {{"ms", 1}};
            if (fault == "another_folder") return {{"answers", "/etc/hostname"}};
            if (fault == "link")
                std::filesystem::create_symlink("/etc/hostname", folder + message["answers"].get<std::string>());
            if (fault == "link") return {{"ms", 1}};
            if (fault == "not_json") return "Rendering ...";
            if (fault == "floods")
                while (true) std::cout << "............................................................";
            const std::vector<float> s = answers();
            const bool as_picture      = fault == "raster" && !raster.empty();
            write(folder + message["answers"].get<std::string>(), s,
                  as_picture ? "(" + std::to_string(raster[1]) + ", " + std::to_string(raster[0]) + ")"
                             : "(" + std::to_string(s.size()) + ",)");
        }
        return {{"ms", fault == "negative_time" ? -1 : 2.5}};
    }
};

}  // namespace

int main(int argc, char** argv) {
    World world{.folder = {}, .fault = argc > 1 ? argv[1] : "none"};
    if (world.fault == "litters")
        std::ofstream(std::filesystem::temp_directory_path() / "umbra-litter") << "left behind";
    if (world.fault == "children" && fork() == 0) std::this_thread::sleep_for(std::chrono::seconds(3600));
    for (std::string line; std::getline(std::cin, line);) {
        const json message = json::parse(line);
        if (message["message"] == "end") return 0;
        const json answer = world.answer(message);
        std::cout << (answer.is_string() ? answer.get<std::string>() : answer.dump()) << std::endl;
    }
    return 0;
}
