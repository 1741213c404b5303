#include "umbra/tests/fuzz/targets.h"

#include <algorithm>
#include <array>
#include <string>

#include "umbra/bench/diff/diff.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/fuzz/pipeline.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// The folder that all runs of this process write their file to.
const TemporaryFolder& folder() {
    static const TemporaryFolder all;
    return all;
}

template <class Read>
void read_or_refuse(const Read& read) {
    try {
        read();
    } catch (const InputError&) {
        return;
    } catch (const UsageError&) {
        return;
    }
}

void read_scene(const std::string& name, Bytes bytes) {
    read_or_refuse([&] { (void)load_scene(folder().write(name, text_of(bytes))); });
}

void json(Bytes bytes) { read_scene("scene.json", bytes); }
void gltf(Bytes bytes) { read_scene("scene.gltf", bytes); }
void glb(Bytes bytes) { read_scene("scene.glb", bytes); }
void obj(Bytes bytes) { read_scene("scene.obj", bytes); }
void ply(Bytes bytes) { read_scene("scene.ply", bytes); }
void stl(Bytes bytes) { read_scene("scene.stl", bytes); }
void off(Bytes bytes) { read_scene("scene.off", bytes); }
void nff(Bytes bytes) { read_scene("scene.nff", bytes); }

void mtl(Bytes bytes) {
    static const fs::path mesh = folder().write(
        "material.obj", "mtllib library.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl b\nf 3 2 1\n");
    (void)folder().write("library.mtl", text_of(bytes));
    read_or_refuse([&] { (void)load_scene(mesh); });
}

void ies(Bytes bytes) {
    static const fs::path scene =
        folder().write("goniometric.json", R"({"lights": [{"type": "point", "position": [0, 2, 0], "ies": "light.ies"}],
            "objects": [{"type": "box"}]})");
    (void)folder().write("light.ies", text_of(bytes));
    read_or_refuse([&] { (void)load_scene(scene); });
}

/// The ending under which the bytes are most likely to be read far.
std::string image_ending(Bytes bytes) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kinds{{{"\x76\x2f\x31\x01", ".exr"},
                                                                                  {"\x89PNG", ".png"},
                                                                                  {"P", ".ppm"},
                                                                                  {"#?", ".hdr"},
                                                                                  {"II*", ".tif"},
                                                                                  {"MM", ".tif"},
                                                                                  {"\xff\xd8", ".jpg"}}};
    for (const auto& [magic, ending] : kinds)
        if (text_of(bytes).starts_with(magic)) return std::string(ending);
    return ".png";
}

/// As `umbra diff` reads it: with itself, and with a picture of 4 x 4.
void image(Bytes bytes) {
    static const fs::path other = [] {
        Image grey(4, 4, {"R", "G", "B"});
        write_image(folder().path() / "other.exr", grey);
        return folder().path() / "other.exr";
    }();
    const fs::path file = folder().write("image" + image_ending(bytes), text_of(bytes));
    (void)diff(file, file, {});
    (void)diff(file, other, {});
}

void report(Bytes bytes) {
    static const fs::path out = [] {
        for (const char* file : {"a.png", "a.exr", "b.png"}) (void)folder().write(std::string("run/") + file, "x");
        return folder().path() / "report";
    }();
    const fs::path run = folder().write("run/results.json", text_of(bytes)).parent_path();
    read_or_refuse([&] { write_report({run}, out); });
    std::error_code ignored;
    fs::remove_all(out, ignored);
}

void pipeline(Bytes bytes) {
    const fs::path file = folder().write("scene.json", text_of(bytes));
    read_or_refuse([&] { run_pipeline(file); });
}

constexpr std::array kTargets{FuzzTarget{"json", json, true},
                              FuzzTarget{"gltf", gltf, true},
                              FuzzTarget{"glb", glb},
                              FuzzTarget{"obj", obj},
                              FuzzTarget{"mtl", mtl},
                              FuzzTarget{"ply", ply},
                              FuzzTarget{"stl", stl},
                              FuzzTarget{"off", off},
                              FuzzTarget{"nff", nff},
                              FuzzTarget{"ies", ies},
                              FuzzTarget{"image", image},
                              FuzzTarget{"report", report, true},
                              FuzzTarget{"pipeline", pipeline, true}};

}  // namespace

std::span<const FuzzTarget> fuzz_targets() { return kTargets; }

const FuzzTarget* find_fuzz_target(std::string_view name) {
    const auto* found = std::ranges::find(kTargets, name, &FuzzTarget::name);
    return found == kTargets.end() ? nullptr : found;
}

}  // namespace umbra
