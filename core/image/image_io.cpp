#include "umbra/core/image/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/paths.h"
#include "umbra/core/image/image_headers.h"
#include "umbra/core/image/image_library.h"

namespace umbra {
namespace {

/// The library's reason in one line.
std::string one_line(std::string reason) {
    while (!reason.empty() && std::isspace(static_cast<unsigned char>(reason.back()))) reason.pop_back();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return reason.empty() ? "unknown reason" : reason;
}

/// The name that OpenEXR gives a matrix; the library has names of its own.
std::string standard_name(const std::string& name) {
    for (const char* standard : {"worldToCamera", "worldToNDC"})
        if (OIIO::Strutil::iequals(name, standard)) return standard;
    return name;
}

/// Refuses pictures that would take too much memory, or cannot be compared pixel by pixel, from the header alone.
/// `held`: values of the parts before.
void check_header(const std::filesystem::path& file, const OIIO::ImageSpec& spec, std::size_t held) {
    if (spec.deep) throw InputError(fmt::format("{}: deep image (flat ones are read)", file.string()));
    if (spec.depth > 1) throw InputError(fmt::format("{}: volume (pictures are read)", file.string()));
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        throw InputError(fmt::format("{}: empty image: {}x{} pixels, {} channels", file.string(), spec.width,
                                     spec.height, spec.nchannels));
    const std::size_t pixels = std::size_t(spec.width) * std::size_t(spec.height);
    // 4 channels of the largest picture; many channels of a smaller one.
    if (pixels > kMaxPixels || held + pixels * std::size_t(spec.nchannels) > 4 * kMaxPixels)
        throw InputError(fmt::format(
            "{}: too large: {}x{} pixels, {} channels{} (at most {} million pixels, and 4 "
            "times as many values)",
            file.string(), spec.width, spec.height, spec.nchannels,
            held > 0 ? fmt::format(" after {} million values of other parts", held >> 20) : "", kMaxPixels >> 20));
}

/// Neighbouring channels of a file that are read as one type.
struct ChannelRun {
    int begin = 0, end = 0;
    bool is_integer = false;
};

/// Unsigned channels of 32 bits are runs of integers; a file without is one run of floats.
std::vector<ChannelRun> channel_runs(const OIIO::ImageSpec& spec) {
    const auto is_integer = [&](int c) { return spec.channelformat(c).basetype == OIIO::TypeDesc::UINT32; };
    std::vector<ChannelRun> runs;
    for (int c = 0; c < spec.nchannels; ++c) {
        if (runs.empty() || runs.back().is_integer != is_integer(c)) runs.push_back({c, c, is_integer(c)});
        runs.back().end = c + 1;
    }
    return runs;
}

/// Some rows of one run of channels, interleaved; a row of tiles where the file has tiles.
template <class Value>
void read_rows(const std::filesystem::path& file, OIIO::ImageInput& input, const ChannelRun& run, int y, int rows,
               OIIO::TypeDesc type, Value* into) {
    const OIIO::ImageSpec& spec = input.spec();
    const int part = input.current_subimage(), top = spec.y + y;
    const bool done = spec.tile_height > 0
                          ? input.read_tiles(part, 0, spec.x, spec.x + spec.width, top, top + rows, spec.z, spec.z + 1,
                                             run.begin, run.end, type, into)
                          : input.read_scanlines(part, 0, top, top + rows, spec.z, run.begin, run.end, type, into);
    if (!done || input.has_error())
        throw InputError(fmt::format("{}: cannot read image: {}", file.string(), one_line(input.geterror())));
}

/// Reads a few rows at a time, or a row of tiles, and lets memory grow with the rows that have been read: headers lie
/// about sizes.
void read_pixels(const std::filesystem::path& file, OIIO::ImageInput& input, Image& image) {
    const OIIO::ImageSpec& spec        = input.spec();
    const std::vector<ChannelRun> runs = channel_runs(spec);
    image.channels.clear();
    for (const ChannelRun& run : runs)
        for (int c = run.begin; c < run.end; ++c) {
            const std::string& name = spec.channelnames[std::size_t(c)];
            if (run.is_integer)
                image.integers[name];
            else
                image.channels.push_back(name);
        }
    const std::size_t channels = image.channels.size(), width = std::size_t(spec.width), row = width * channels;
    const int strip = spec.tile_height > 0 ? spec.tile_height : 64;
    std::vector<float> floats;
    std::vector<std::uint32_t> integers;
    for (int y = 0; y < spec.height; y += strip) {
        const int rows           = std::min(strip, spec.height - y);
        const std::size_t pixels = width * std::size_t(rows);
        image.data.resize(row * std::size_t(y + rows));
        float* const begin = image.data.data() + row * std::size_t(y);
        std::size_t first  = 0;  // of the run, among the channels of floats
        for (const ChannelRun& run : runs) {
            const std::size_t n = std::size_t(run.end - run.begin);
            if (runs.size() == 1 && !run.is_integer) {
                read_rows(file, input, run, y, rows, OIIO::TypeDesc::FLOAT, begin);
            } else if (run.is_integer) {
                integers.resize(pixels * n);
                read_rows(file, input, run, y, rows, OIIO::TypeDesc::UINT32, integers.data());
                for (std::size_t c = 0; c < n; ++c) {
                    auto& values = image.integers[spec.channelnames[std::size_t(run.begin) + c]];
                    for (std::size_t i = 0; i < pixels; ++i) values.push_back(integers[i * n + c]);
                }
            } else {
                floats.resize(pixels * n);
                read_rows(file, input, run, y, rows, OIIO::TypeDesc::FLOAT, floats.data());
                for (std::size_t i = 0; i < pixels; ++i)
                    std::copy_n(floats.data() + i * n, n, begin + i * channels + first);
                first += n;
            }
        }
    }
}

/// The library multiplies by a rounded 1 / levels; this divides, so that 8 and 16 bits of one value are one float.
void round_once(Image& image, double levels) {
    for (float& x : image.data) x = float(std::floor(double(x) * levels + 0.5) / levels);  // none is negative
}

constexpr const char* kDisplayWindows = "display windows";

std::string window_text(int width, int height, int x, int y) {
    return fmt::format("{}x{} from ({}, {})", width, height, x, y);
}

/// The file's statements about how its pixels are shown. Those that repeat the default of a file without them are left
/// out.
std::map<std::string, std::string> shown_as(const OIIO::ImageSpec& spec, Encoding encoding) {
    std::map<std::string, std::string> said;
    const std::string shown = window_text(spec.full_width, spec.full_height, spec.full_x, spec.full_y);
    if (shown != window_text(spec.width, spec.height, spec.x, spec.y)) said[kDisplayWindows] = shown;
    if (const int way = spec.get_int_attribute("Orientation", 1); way != 1)
        said["orientations"] = fmt::format("{} of EXIF", way);
    if (const std::string aspect = fmt::format("{:.4g}", spec.get_float_attribute("PixelAspectRatio", 1));
        aspect != "1")
        said["pixel aspect ratios"] = aspect;

    const auto is    = [](std::string_view a, std::string_view b) { return OIIO::Strutil::iequals(a, b); };
    const auto curve = spec["oiio:ColorSpace"].get<std::string>();
    const bool usual = curve.empty() || is(curve, "sRGB") || is(curve, "Gamma2.2") || is(curve, "scene_linear") ||
                       (is(curve, "linear") && encoding == Encoding::linear);
    std::vector<std::string> colours;
    if (!usual) colours.push_back(curve);
    constexpr std::array<float, 8> rec709{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    if (const auto* found = spec.find_attribute("chromaticities"); found != nullptr && found->datasize() == 32) {
        const auto* xy  = static_cast<const float*>(found->data());
        const auto near = [](float a, float b) { return std::abs(a - b) < 5e-4f; };
        if (!std::equal(rec709.begin(), rec709.end(), xy, near))
            colours.push_back(fmt::format("chromaticities {:.4g}", fmt::join(xy, xy + rec709.size(), " ")));
    }
    if (const auto* icc = spec.find_attribute("ICCProfile"); icc != nullptr) {
        const auto name = spec["ICCProfile:profile_description"].get<std::string>();
        if (name.find("sRGB") == std::string::npos || name.find("inear") != std::string::npos)
            colours.push_back(fmt::format("ICC profile \"{}\" of {} bytes", name, icc->datasize()));
    }
    if (!colours.empty()) said["colours"] = fmt::format("{}", fmt::join(colours, ", "));
    return said;
}

/// The part at which `input` is.
LoadedImage read_part(const std::filesystem::path& file, OIIO::ImageInput& input) {
    const OIIO::ImageSpec& spec = input.spec();
    LoadedImage loaded;
    loaded.image.width          = spec.width;
    loaded.image.height         = spec.height;
    loaded.x                    = spec.x;
    loaded.y                    = spec.y;
    const auto stored           = OIIO::TypeDesc::BASETYPE(spec.format.basetype);
    const bool is_short_integer = stored == OIIO::TypeDesc::UINT8 || stored == OIIO::TypeDesc::INT8 ||
                                  stored == OIIO::TypeDesc::UINT16 || stored == OIIO::TypeDesc::INT16;
    loaded.encoding = is_short_integer ? Encoding::srgb : Encoding::linear;
    loaded.shown_as = shown_as(spec, loaded.encoding);
    for (const OIIO::ParamValue& attribute : spec.extra_attribs)
        if (attribute.type() == OIIO::TypeDesc::STRING)
            loaded.image.metadata[attribute.name().string()] = attribute.get_string();
        else if (attribute.type() == OIIO::TypeMatrix)
            std::copy_n(static_cast<const float*>(attribute.data()), 16,
                        loaded.image.matrices[standard_name(attribute.name().string())].begin());
    read_pixels(file, input, loaded.image);
    if (stored == OIIO::TypeDesc::UINT8) round_once(loaded.image, 255);
    if (stored == OIIO::TypeDesc::UINT16) round_once(loaded.image, 65535);
    return loaded;
}

/// The parts as one image: the first's channels as they are, those of another as "PART.CHANNEL".
LoadedImage joined(const std::filesystem::path& file, std::vector<LoadedImage> parts,
                   const std::vector<std::string>& names) {
    LoadedImage whole = std::move(parts.at(0));
    Image& image      = whole.image;
    std::set<std::string> taken(image.channels.begin(), image.channels.end());
    const auto take = [&](const std::string& part, const std::string& channel) {
        std::string name = channel.starts_with(part + ".") ? channel : part + "." + channel;
        if (!taken.insert(name).second)
            throw InputError(fmt::format("{}: two channels are called {}", file.string(), name));
        return name;
    };
    for (const auto& integer : image.integers) taken.insert(integer.first);
    if (taken.size() < image.channels.size() + image.integers.size())
        throw InputError(
            fmt::format("{}: two channels have one name: {}", file.string(), fmt::join(image.channels, " ")));
    std::vector<const Image*> with_floats{&image};
    std::vector<std::string> channels = image.channels;
    for (std::size_t k = 1; k < parts.size(); ++k) {
        const std::string part = names[k].empty() ? std::to_string(k + 1) : names[k];
        if (const auto unlike = layout_differences(whole, parts[k]); !unlike.empty())
            throw InputError(fmt::format("{}: part {} is not as the first: {} (parts of one size and place are read)",
                                         file.string(), part, fmt::join(unlike, "; ")));
        if (whole.encoding != parts[k].encoding)
            throw InputError(
                fmt::format("{}: part {} is not as the first: one holds linear light, the other sRGB "
                            "(parts of one kind are read)",
                            file.string(), part));
        for (const std::string& channel : parts[k].image.channels) channels.push_back(take(part, channel));
        for (auto& [channel, values] : parts[k].image.integers) image.integers[take(part, channel)] = std::move(values);
        with_floats.push_back(&parts[k].image);
    }
    if (parts.size() > 1) {
        std::vector<float> data(image.pixels() * channels.size());
        std::size_t first = 0;
        for (const Image* part : with_floats) {
            const std::size_t n = part->channels.size();
            for (std::size_t i = 0; i < image.pixels(); ++i)
                std::copy_n(part->data.data() + i * n, n, data.data() + i * channels.size() + first);
            first += n;
        }
        image.channels = std::move(channels);
        image.data     = std::move(data);
    }
    return whole;
}

/// A file beside `file` with the same ending, which tells the format; removed unless it was moved away. Its name is
/// fixed, so that killed processes leave at most one; another process that writes the same file waits here.
class Partial {
public:
    explicit Partial(const std::filesystem::path& file)
        : path(file.parent_path() / fmt::format(".umbra-part.{}", file.filename().string())) {
        struct stat open_file {
        }, named{};
        do {
            if (descriptor_ >= 0) ::close(descriptor_);
            descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
            if (descriptor_ < 0) throw std::runtime_error(std::strerror(errno));
            while (::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
            }  // a file system without locks: without
        } while (::fstat(descriptor_, &open_file) == 0 &&
                 (::stat(path.c_str(), &named) != 0 || named.st_ino != open_file.st_ino));
    }
    ~Partial() {
        struct stat open_file {
        }, named{};
        std::error_code ignored;
        if (::fstat(descriptor_, &open_file) == 0 && ::stat(path.c_str(), &named) == 0 &&
            named.st_ino == open_file.st_ino)
            std::filesystem::remove(path, ignored);
        ::close(descriptor_);
    }
    Partial(const Partial&)            = delete;
    Partial& operator=(const Partial&) = delete;

    const std::filesystem::path path;

private:
    int descriptor_ = -1;
};

std::vector<unsigned char> to_8_bit(const Image& image, std::size_t channels) {
    std::vector<unsigned char> bytes(image.pixels() * channels);
    const std::size_t all = image.channels.size();
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (std::size_t c = 0; c < channels; ++c) {
            const float x           = image.data[i * all + c];
            const float bounded     = x > 0 ? std::min(x, 1.0f) : 0.0f;  // NaN: 0
            bytes[i * channels + c] = static_cast<unsigned char>(std::floor(double(255 * bounded) + 0.5));
        }
    return bytes;
}

constexpr int kPngFilterNone = 0x08;  // PNG_FILTER_NONE of png.h

std::size_t png_channels(const Image& image) {
    const std::size_t n = image.channels.size();
    if (n < 3) return 1;
    return n > 3 && image.channels[3] == "A" ? 4 : 3;
}

/// Floats and integers of each pixel side by side, bit by bit.
std::vector<std::uint32_t> interleaved(const Image& image) {
    const std::size_t floats = image.channels.size(), all = floats + image.integers.size();
    std::vector<std::uint32_t> values(image.pixels() * all);
    std::vector<const std::uint32_t*> integers;
    for (const auto& channel : image.integers) integers.push_back(channel.second.data());
    parallel_ranges(image.pixels(), 16384, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::uint32_t* to = &values[i * all];
            for (std::size_t c = 0; c < floats; ++c) *to++ = std::bit_cast<std::uint32_t>(image.at(i, c));
            for (const std::uint32_t* integer : integers) *to++ = integer[i];
        }
    });
    return values;
}

/// `memory`, where it is given, takes the bytes in place of the file.
void write_pixels(OIIO::ImageOutput& output, const std::filesystem::path& path, const Image& image, bool is_png,
                  OIIO::Filesystem::IOProxy* memory = nullptr) {
    const auto check = [&](bool done) {
        if (!done) throw std::runtime_error(one_line(output.geterror()));
    };
    const std::size_t channels = is_png ? png_channels(image) : image.channels.size();
    OIIO::ImageSpec spec(image.width, image.height, int(channels),
                         is_png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
    spec.channelnames.assign(image.channels.begin(), image.channels.begin() + std::ptrdiff_t(channels));
    spec.attribute("DateTime", "");  // the library writes the time of day otherwise: other bytes each second
    for (const auto& [key, value] : image.metadata) spec.attribute(key, value);
    if (is_png) {
        spec.attribute("oiio:ColorSpace", "sRGB");
        spec.attribute("oiio:UnassociatedAlpha", 1);
        // Rows as they are: large areas of one colour pack smaller than with libpng's choice of filters, in half the
        // time.
        spec.attribute("png:filter", kPngFilterNone);
    } else {
        spec.attribute("compression", "zips:1");  // 2.5 times as fast as piz, files larger by a quarter
        for (const auto& [name, matrix] : image.matrices) spec.attribute(name, OIIO::TypeMatrix, matrix.data());
        if (!image.integers.empty()) spec.channelformats.assign(channels, OIIO::TypeDesc::FLOAT);
        for (const auto& integer : image.integers) {
            spec.channelnames.push_back(integer.first);
            spec.channelformats.emplace_back(OIIO::TypeDesc::UINT32);
            ++spec.nchannels;
        }
    }
    if (memory != nullptr) spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &memory);
    check(output.open(path.string(), spec));
    if (is_png)
        check(output.write_image(OIIO::TypeDesc::UINT8, to_8_bit(image, channels).data()));
    else if (image.integers.empty())
        check(output.write_image(OIIO::TypeDesc::FLOAT, image.data.data()));
    else  // every channel in its own type
        check(output.write_image(OIIO::TypeDesc::UNKNOWN, interleaved(image).data()));
    check(output.close());
}

}  // namespace

std::vector<std::string> layout_differences(const LoadedImage& a, const LoadedImage& b) {
    std::vector<std::string> reasons;
    if (a.image.width != b.image.width || a.image.height != b.image.height)
        reasons.push_back(fmt::format("sizes differ: {}x{} against {}x{}", a.image.width, a.image.height, b.image.width,
                                      b.image.height));
    if (a.x != b.x || a.y != b.y)
        reasons.push_back(fmt::format("data windows differ: begin at ({}, {}) against ({}, {})", a.x, a.y, b.x, b.y));
    std::map<std::string, std::string> either = a.shown_as;
    either.insert(b.shown_as.begin(), b.shown_as.end());
    for (const auto& [what, unused] : either) {
        const auto in = [&, &of = what](const LoadedImage& x) {
            const auto said = x.shown_as.find(of);
            if (said != x.shown_as.end()) return said->second;
            return of == kDisplayWindows ? window_text(x.image.width, x.image.height, x.x, x.y)
                                         : std::string("nothing said");
        };
        if (in(a) != in(b)) reasons.push_back(fmt::format("{} differ: {} against {}", what, in(a), in(b)));
    }
    return reasons;
}

LoadedImage read_image(const std::filesystem::path& file) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: no such file", file.string()));
    if (std::filesystem::is_directory(status))
        throw InputError(fmt::format("{}: is a folder (an image file is needed)", file.string()));
    try {
        if (const std::string claim = find_false_claim(file); !claim.empty())
            throw InputError(fmt::format("{}: cannot read image: {}", file.string(), claim));
        OIIO::ImageSpec wish;
        wish.attribute("oiio:UnassociatedAlpha", 1);  // as stored, not multiplied by alpha
        const auto input = OIIO::ImageInput::open(file.string(), &wish);
        if (!input)
            throw InputError(fmt::format("{}: cannot read image: {}", file.string(), one_line(OIIO::geterror())));
        std::vector<LoadedImage> parts;
        std::vector<std::string> names;
        std::size_t claimed = 1;
        for (std::size_t held = 0; input->seek_subimage(int(parts.size()), 0);) {
            const OIIO::ImageSpec& spec = input->spec();
            claimed                     = std::size_t(std::max(1, spec.get_int_attribute("oiio:subimages", 1)));
            check_header(file, spec, held);
            held += std::size_t(spec.width) * std::size_t(spec.height) * std::size_t(spec.nchannels);
            names.push_back(spec["oiio:subimagename"].get<std::string>());
            parts.push_back(read_part(file, *input));
            if (input->seek_subimage(int(parts.size()) - 1, 1))
                throw InputError(
                    fmt::format("{}: has smaller copies of its pixels, mip levels (pictures are read)", file.string()));
        }
        if (parts.size() < claimed)
            throw InputError(fmt::format("{}: cannot read image: part {} of {}: {}", file.string(), parts.size() + 1,
                                         claimed, one_line(input->geterror())));
        LoadedImage loaded = joined(file, std::move(parts), names);
        spread_integers(loaded.image);
        return loaded;
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& reason) {  // thrown by a decoder through the library
        throw InputError(fmt::format("{}: cannot read image: {}", file.string(), one_line(reason.what())));
    }
}

void write_image(const std::filesystem::path& file, const Image& image) {
    const std::string ending = file.extension().string();
    if (ending != ".exr" && ending != ".png")
        throw InputError(fmt::format("{}: cannot write image: unknown ending (.exr or .png)", file.string()));
    const bool whole = std::all_of(image.integers.begin(), image.integers.end(),
                                   [&](const auto& channel) { return channel.second.size() == image.pixels(); });
    if (image.channels.empty() || image.data.size() != image.pixels() * image.channels.size() || image.data.empty() ||
        !whole)
        throw std::logic_error("write_image: the image is empty, or its size and its data disagree");
    const std::filesystem::path folder = file.parent_path();
    if (!folder.empty() && !is_folder(folder))
        throw InputError(fmt::format("{}: cannot write image: no folder {}", file.string(), folder.string()));
    try {
        const Partial partial(file);
        const auto output = OIIO::ImageOutput::create(partial.path.string());
        if (!output) throw std::runtime_error(one_line(OIIO::geterror()));
        write_pixels(*output, partial.path, image, ending == ".png");
        std::filesystem::rename(partial.path, file);
    } catch (const std::exception& reason) {
        throw InputError(fmt::format("{}: cannot write image: {}", file.string(), reason.what()));
    }
}

std::string png_bytes(const Image& image) {
    OIIO::Filesystem::IOVecOutput bytes;
    const std::filesystem::path name = "memory.png";  // says the format, no more
    const auto output                = OIIO::ImageOutput::create(name.string());
    if (!output) throw std::runtime_error(one_line(OIIO::geterror()));
    write_pixels(*output, name, image, true, &bytes);
    return {bytes.buffer().begin(), bytes.buffer().end()};
}

}  // namespace umbra

extern "C" __attribute__((visibility("default"))) const umbra::ImageLibrary umbra_image_library = {
    umbra::layout_differences, umbra::read_image, umbra::write_image, umbra::png_bytes};
