#include <array>
#include <charconv>
#include <functional>
#include <string>
#include <string_view>

#include "umbra/core/image/image_headers.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/fuzz/fuzz_folder.h"
#include "umbra/tests/fuzz/targets.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

void load_or_refuse(const fs::path& file) {
    read_or_refuse([&] { (void)load_scene(file); });
}

/// Whether a shape of a native scene is cut finer than any of the seeds: 700 bytes can ask for seven million triangles,
/// which take as long to make as a hundred thousand other files take to read.
bool finely_cut(std::string_view text) {
    constexpr int usual = 128;
    for (const std::string_view key : {"segments", "divisions", "longitudes", "latitudes", "around", "tube"})
        for (std::size_t at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
            const std::size_t number = text.find_first_not_of("\": \n\t", at + key.size());
            double value             = 0;
            if (number == text.npos) break;
            (void)std::from_chars(text.data() + number, text.data() + text.size(), value);
            if (value > usual) return true;
        }
    return false;
}

/// Of finely cut scenes one of 64 is read.
void json(Bytes bytes) {
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    if (finely_cut(text) && std::hash<std::string_view>{}(text) % 64 != 0) return;
    load_or_refuse(rewrite("scene.json", bytes));
}
void gltf(Bytes bytes) { load_or_refuse(rewrite("scene.gltf", bytes)); }
void glb(Bytes bytes) { load_or_refuse(rewrite("scene.glb", bytes)); }
void obj(Bytes bytes) { load_or_refuse(rewrite("scene.obj", bytes)); }
void ply(Bytes bytes) { load_or_refuse(rewrite("scene.ply", bytes)); }
void stl(Bytes bytes) { load_or_refuse(rewrite("scene.stl", bytes)); }
void off(Bytes bytes) { load_or_refuse(rewrite("scene.off", bytes)); }
void nff(Bytes bytes) { load_or_refuse(rewrite("scene.nff", bytes)); }

void mtl(Bytes bytes) {
    static const fs::path mesh = fuzz_folder().write(
        "material.obj", "mtllib library.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl b\nf 3 2 1\n");
    (void)rewrite("library.mtl", bytes);
    load_or_refuse(mesh);
}

void ies(Bytes bytes) {
    static const fs::path scene = fuzz_folder().write(
        "goniometric.json", R"({"lights": [{"type": "point", "position": [0, 2, 0], "ies": "light.ies"}],
            "objects": [{"type": "box"}]})");
    (void)rewrite("light.ies", bytes);
    load_or_refuse(scene);
}

/// What is asked of a picture before a decoder sees it.
void headers(Bytes bytes) { (void)find_false_claim(rewrite("picture", bytes)); }

constexpr std::array kTargets{FuzzTarget{"json", json, true}, FuzzTarget{"gltf", gltf, true}, FuzzTarget{"glb", glb},
                              FuzzTarget{"obj", obj},         FuzzTarget{"mtl", mtl},         FuzzTarget{"ply", ply},
                              FuzzTarget{"stl", stl},         FuzzTarget{"off", off},         FuzzTarget{"nff", nff},
                              FuzzTarget{"ies", ies},         FuzzTarget{"headers", headers}};

}  // namespace

std::span<const FuzzTarget> reader_targets() { return kTargets; }

}  // namespace umbra
