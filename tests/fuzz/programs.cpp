#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <string_view>

#include "umbra/bench/gate/diff.h"
#include "umbra/bench/report/report.h"
#include "umbra/bench/view/view_session.h"
#include "umbra/core/image/image_headers.h"
#include "umbra/core/image/image_io.h"
#include "umbra/tests/fuzz/fuzz_folder.h"
#include "umbra/tests/fuzz/pipeline.h"
#include "umbra/tests/fuzz/targets.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// The ending under which the bytes are most likely to be read far.
std::string image_ending(Bytes bytes) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kinds{{{"\x76\x2f\x31\x01", ".exr"},
                                                                                  {"\x89PNG", ".png"},
                                                                                  {"P", ".ppm"},
                                                                                  {"#?", ".hdr"},
                                                                                  {"II*", ".tif"},
                                                                                  {"MM", ".tif"},
                                                                                  {"\xff\xd8", ".jpg"}}};
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    for (const auto& [magic, ending] : kinds)
        if (text.starts_with(magic)) return std::string(ending);
    return ".png";
}

/// Whether the header claims more than 65,536 pixels: decoders take and clear memory for them, which takes as long as
/// hundreds of small files.
bool is_large(const fs::path& file) {
    if (!find_false_claim(file).empty()) return false;  // as read_image does, before a decoder sees it
    const auto in = OIIO::ImageInput::open(file.string());
    (void)OIIO::geterror();
    return in && in->spec().image_pixels() > 1 << 16;
}

/// As `umbra diff` reads it: with itself, and with a picture of 4 x 4. Of large ones, one of 64.
void image(Bytes bytes) {
    static const fs::path other = [] {
        Image grey(4, 4, {"R", "G", "B"});
        write_image(fuzz_folder().path() / "other.exr", grey);
        return fuzz_folder().path() / "other.exr";
    }();
    const fs::path file = rewrite("image" + image_ending(bytes), bytes);
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    if (std::hash<std::string_view>{}(text) % 64 != 0 && is_large(file)) return;
    (void)diff(file, file, {});
    (void)diff(file, other, {});
}

void report(Bytes bytes) {
    static const fs::path out = [] {
        for (const char* file : {"a.png", "a.exr", "b.png"}) (void)fuzz_folder().write(std::string("run/") + file, "x");
        return fuzz_folder().path() / "report";
    }();
    const fs::path run = rewrite("run/results.json", bytes).parent_path();
    read_or_refuse([&] { write_report({run}, out); });
    std::error_code ignored;
    fs::remove_all(out, ignored);
}

void pipeline(Bytes bytes) {
    const fs::path file = rewrite("scene.json", bytes);
    read_or_refuse([&] { run_pipeline(file); });
}

/// As one page of `umbra view` would, whose session lives on: the body of a request, of which nothing but the size of
/// the picture and the time are cut down, and the question why at each pixel that it names.
void view(Bytes bytes) {
    static ViewSession session(fuzz_folder().write("viewed.json", R"({"size": [16, 16], "camera": {"eye": [0, 3, 4],
        "target": [0, 0, 0]}, "lights": [{"type": "point", "position": [1, 3, 1]},
        {"type": "rectangle", "position": [0, 4, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}],
        "objects": [{"type": "plane", "size": [6, 6]}, {"name": "lid", "type": "box", "transform": [{"translate": [0, 0.6, 0]}]}],
        "animation": {"frames": 3, "objects": {"lid": {"keys": [{"frame": 2, "turn": 90}]}}}})"));
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    read_or_refuse([&] {
        ViewRequest wanted      = view_request(std::string(text));
        wanted.width            = std::min<std::uint64_t>(wanted.width, 24);
        wanted.height           = std::min<std::uint64_t>(wanted.height, 16);
        constexpr Budget little = {.seconds = 0.05, .bytes = 64e6};
        (void)session.show(wanted, little);
        if (wanted.x && wanted.y) (void)session.why(wanted, little);
        (void)session.scene_text();
    });
}

constexpr std::array kTargets{FuzzTarget{"image", image}, FuzzTarget{"report", report, true},
                              FuzzTarget{"pipeline", pipeline, true}, FuzzTarget{"view", view, true}};

}  // namespace

std::span<const FuzzTarget> program_targets() { return kTargets; }

}  // namespace umbra
