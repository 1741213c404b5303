// This work is based on:
// Khronos Group. glTF 2.0 Specification, section 3.9.4 (Alpha Coverage). 2021; KHR_texture_transform. 2018
// Ivan Sutherland, Gary Hodgman. Reentrant Polygon Clipping. 1974
#include "umbra/core/io/gltf/cutout.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"

namespace umbra {
namespace {

constexpr double kMostTexels = 1 << 30;  ///< looked at for one mesh: some seconds
constexpr double kSliver     = 1e-6;     ///< of a texel or, if smaller, of the triangle: rounding alone
constexpr double kNoArea     = 1e-14;    ///< texels

/// Bytes as a file of memory alone: nothing is left where the program ends.
class MemoryFile {
public:
    explicit MemoryFile(std::string_view bytes) : handle_(memfd_create("texture", MFD_CLOEXEC)) {
        while (handle_ >= 0 && !bytes.empty()) {
            const auto written = ::write(handle_, bytes.data(), bytes.size());
            if (written <= 0) break;  // the reader of the file then reports that it is short
            bytes.remove_prefix(std::size_t(written));
        }
    }
    ~MemoryFile() {
        if (handle_ >= 0) ::close(handle_);
    }
    MemoryFile(const MemoryFile&)            = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] std::filesystem::path path() const { return fmt::format("/proc/self/fd/{}", handle_); }

private:
    int handle_;
};

/// The image of a texture, of the formats that extensions add where it has no other.
const JsonValue& image_of(const JsonText& json, const JsonValue& texture) {
    const JsonArray& images = list_of(json, json.root(), "images");
    const JsonValue* source = find_member(texture, "source");
    for (const std::string_view name : {"EXT_texture_webp", "MSFT_texture_dds", "KHR_texture_basisu"})
        if (const JsonValue* other = source ? nullptr : extension(json, texture, name))
            source = find_member(*other, "source");
    if (!source) json.fail(texture, "this texture has no source");
    return images[index_into(json, *source, "image", images.size())];
}

Cutout::Wrap wrap_of(const JsonText& json, const JsonValue* sampler, std::string_view key) {
    const JsonValue* v = sampler ? find_member(*sampler, key) : nullptr;
    const auto code    = v ? whole(json, *v, key, 0, kMaxWhole) : 10497;
    if (code == 33071) return Cutout::Wrap::clamp;
    if (code == 33648) return Cutout::Wrap::mirror;
    if (code != 10497) json.fail(*v, fmt::format("{} is {}, expected 10497, 33071 or 33648", key, code));
    return Cutout::Wrap::repeat;
}

std::int64_t wrapped(std::int64_t i, std::int64_t size, Cutout::Wrap wrap) {
    if (wrap == Cutout::Wrap::clamp) return std::clamp<std::int64_t>(i, 0, size - 1);
    const std::int64_t period = wrap == Cutout::Wrap::mirror ? 2 * size : size;
    const std::int64_t k      = (i % period + period) % period;
    return k < size ? k : period - 1 - k;
}

/// A part of the plane of texels that is kept, [low, high).
struct TexelRect {
    dvec2 low{0}, high{0};
};

/// The texels kept within [low, high) as rectangles: runs of a row, joined with equal ones of the rows before.
std::vector<TexelRect> kept_rectangles(const Cutout& cutout, glm::i64vec2 low, glm::i64vec2 high) {
    struct RowRun {
        std::int64_t begin, end, top;
    };
    std::vector<TexelRect> rectangles;
    std::vector<RowRun> open, runs;
    std::vector<std::size_t> columns;
    for (std::int64_t x = low.x; x < high.x; ++x)
        columns.push_back(static_cast<std::size_t>(wrapped(x, cutout.width, cutout.wrap[0])));
    for (std::int64_t y = low.y; y <= high.y; ++y) {
        runs.clear();
        const std::uint8_t* row = cutout.kept.data() + wrapped(y, cutout.height, cutout.wrap[1]) * cutout.width;
        for (std::int64_t x = low.x; y < high.y && x < high.x; ++x) {
            if (row[columns[static_cast<std::size_t>(x - low.x)]] == 0) continue;
            if (!runs.empty() && runs.back().end == x)
                ++runs.back().end;
            else
                runs.push_back({x, x + 1, y});
        }
        for (const RowRun& above : open) {
            const auto same = std::lower_bound(runs.begin(), runs.end(), above.begin,
                                               [](const RowRun& run, std::int64_t x) { return run.begin < x; });
            if (same != runs.end() && same->begin == above.begin && same->end == above.end)
                same->top = above.top;
            else
                rectangles.push_back({dvec2(above.begin, above.top), dvec2(above.end, y)});
        }
        open = runs;
    }
    return rectangles;
}

/// The part of a convex polygon where sign * p[axis] <= sign * limit.
std::vector<dvec2> clipped(const std::vector<dvec2>& polygon, int axis, double sign, double limit) {
    std::vector<dvec2> out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double da = sign * (limit - a[axis]), db = sign * (limit - b[axis]);
        if (da >= 0) out.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            dvec2 q = a + (b - a) * (da / (da - db));
            q[axis] = limit;
            out.push_back(q);
        }
    }
    return out;
}

double cross2(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }

/// One triangle of a mesh and the map of its texels to space.
class TriangleCut {
public:
    TriangleCut(const Mesh& from, const uvec3& corners, const std::array<dvec2, 3>& texels)
        : from_(from),
          corners_(corners),
          texels_(texels),
          area_(cross2(texels[1] - texels[0], texels[2] - texels[0])) {}

    /// Twice the area in texels, signed.
    [[nodiscard]] double area() const { return area_; }

    void add_part(const TexelRect& rect, Mesh& to) const {
        std::vector<dvec2> polygon(texels_.begin(), texels_.end());
        for (int axis = 0; axis < 2; ++axis) {
            polygon = clipped(polygon, axis, 1, rect.high[axis]);
            polygon = clipped(polygon, axis, -1, rect.low[axis]);
        }
        const auto first      = static_cast<std::uint32_t>(to.positions.size());
        std::uint32_t count   = 0;
        const double rounding = kSliver * std::min(1.0, std::abs(area_));
        for (std::uint32_t k = 1; k + 1 < polygon.size(); ++k) {
            if (std::abs(cross2(polygon[k] - polygon[0], polygon[k + 1] - polygon[0])) <= rounding) continue;
            to.triangles.emplace_back(first, first + k, first + k + 1);
            ++count;
        }
        if (count > 0)
            for (const dvec2 p : polygon) add_vertex(shares_at(p), to);
    }

    void add_whole(Mesh& to) const {
        const auto first = static_cast<std::uint32_t>(to.positions.size());
        for (const dvec3 corner : {dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 1)}) add_vertex(corner, to);
        to.triangles.emplace_back(first, first + 1, first + 2);
    }

private:
    /// The weight of each corner at p; at a corner exactly 1.
    [[nodiscard]] dvec3 shares_at(dvec2 p) const {
        dvec3 shares(0);
        for (int k = 0; k < 3; ++k)
            shares[k] = cross2(texels_[std::size_t(k + 1) % 3] - p, texels_[std::size_t(k + 2) % 3] - p) / area_;
        for (int k = 0; k < 3; ++k)
            if (p == texels_[std::size_t(k)]) {
                shares    = dvec3(0);
                shares[k] = 1;
            }
        return shares;
    }

    void add_vertex(const dvec3& shares, Mesh& to) const {
        const auto mix = [&](const std::vector<vec3>& values) {
            dvec3 sum(0);
            for (int k = 0; k < 3; ++k) sum += shares[k] * dvec3(values[corners_[k]]);
            return sum;
        };
        to.positions.emplace_back(mix(from_.positions));
        if (from_.normals.empty()) return;
        bool given = true;
        for (int k = 0; k < 3; ++k) given = given && from_.normals[corners_[k]] != vec3(0);
        const dvec3 normal  = mix(from_.normals);
        const double length = glm::length(normal);
        to.normals.push_back(given && length > 0 ? vec3(normal / length) : vec3(0));
    }

    const Mesh& from_;
    const uvec3& corners_;
    std::array<dvec2, 3> texels_;
    double area_;
};

}  // namespace

bool Cutout::keeps(std::int64_t x, std::int64_t y) const {
    const std::int64_t column = wrapped(x, width, wrap[0]), row = wrapped(y, height, wrap[1]);
    return kept[static_cast<std::size_t>(row * width + column)] != 0;
}

Cutout read_cutout(const JsonText& json, GltfData& data, const JsonValue& texture, double least) {
    const JsonArray& textures = list_of(json, json.root(), "textures");
    const JsonArray& samplers = list_of(json, json.root(), "samplers");
    const JsonValue* index    = find_member(texture, "index");
    if (!index) json.fail(texture, "this texture has no index");
    const JsonValue& chosen  = textures[index_into(json, *index, "texture", textures.size())];
    const JsonValue* sampler = find_member(chosen, "sampler");
    if (sampler) sampler = &samplers[index_into(json, *sampler, "sampler", samplers.size())];

    Cutout cutout;
    cutout.wrap            = {wrap_of(json, sampler, "wrapS"), wrap_of(json, sampler, "wrapT")};
    const JsonValue* moved = extension(json, texture, "KHR_texture_transform");
    const JsonValue* set   = moved && find_member(*moved, "texCoord") ? moved : &texture;
    if (const JsonValue* v = find_member(*set, "texCoord")) cutout.set = whole(json, *v, "texCoord", 0, kMaxWhole);
    if (moved) {
        if (number_or(json, moved, "rotation", kAnyNumber, 0) != 0)
            json.fail(*moved, "textures that are turned are not read");
        const auto pair = [&](std::string_view key, dvec2 fallback) {
            const JsonValue* v = find_member(*moved, key);
            if (!v) return fallback;
            const auto x = numbers(json, *v, key, 2, kAnyNumber);
            return dvec2(x[0], x[1]);
        };
        cutout.offset = pair("offset", dvec2(0));
        cutout.scale  = pair("scale", dvec2(1));
    }

    const JsonValue& source = image_of(json, chosen);
    const MemoryFile file(data.image(source));
    const Image image = [&] {
        try {
            return read_image(file.path()).image;
        } catch (const InputError& e) {
            std::string message = e.what();  // names the file that nobody else sees
            for (std::size_t at = 0; (at = message.find(file.path().string())) != message.npos;)
                message.replace(at, file.path().string().size(), "this image");
            json.fail(source, message);
        }
    }();
    cutout.width  = image.width;
    cutout.height = image.height;
    const auto alpha =
        std::size_t(std::find(image.channels.begin(), image.channels.end(), "A") - image.channels.begin());
    for (std::size_t i = 0; i < image.pixels(); ++i)
        cutout.kept.push_back(alpha == image.channels.size() || static_cast<double>(image.at(i, alpha)) >= least);
    return cutout;
}

std::optional<Mesh> cut_out(const Mesh& mesh, const std::vector<dvec2>& at, const Cutout& cutout, std::size_t most) {
    const dvec2 size(cutout.width, cutout.height);
    Mesh out;
    double looked_at = 0;
    for (const uvec3& t : mesh.triangles) {
        std::array<dvec2, 3> texels{};
        for (int k = 0; k < 3; ++k) texels[std::size_t(k)] = (cutout.offset + cutout.scale * at[t[k]]) * size;
        const dvec2 low  = glm::floor(glm::min(glm::min(texels[0], texels[1]), texels[2]));
        const dvec2 high = glm::floor(glm::max(glm::max(texels[0], texels[1]), texels[2])) + 1.0;
        looked_at += (high.x - low.x) * (high.y - low.y);
        if (!(looked_at <= kMostTexels && glm::length(low) < 1e9)) return std::nullopt;
        const TriangleCut triangle(mesh, t, texels);
        if (std::abs(triangle.area()) <= kNoArea) {
            const dvec2 middle = (texels[0] + texels[1] + texels[2]) / 3.0;
            if (cutout.keeps(std::int64_t(std::floor(middle.x)), std::int64_t(std::floor(middle.y))))
                triangle.add_whole(out);
        } else {
            for (const TexelRect& rect : kept_rectangles(cutout, glm::i64vec2(low), glm::i64vec2(high)))
                triangle.add_part(rect, out);
        }
        if (out.triangles.size() > most) return std::nullopt;
    }
    return out;
}

}  // namespace umbra
