#include "umbra/core/image/image_io.h"
#include "umbra/core/image/image_headers.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>

#include "umbra/core/base/error.h"
#include "umbra/core/image/metrics.h"
#include "umbra/tests/support/written_parts.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// A folder that goes away with the test.
class ImageIo : public testing::Test {
protected:
    ImageIo() { fs::create_directories(folder); }
    ~ImageIo() override { fs::remove_all(folder); }
    fs::path folder =
        fs::temp_directory_path() /
        (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "." + std::to_string(getpid()));

    [[nodiscard]] fs::path write(const char* name, const std::string& bytes) const {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        return folder / name;
    }
};

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The message that reading ends in.
std::string refusal(const fs::path& file) {
    try {
        static_cast<void>(read_image(file));
    } catch (const InputError& error) {
        return error.what();
    }
    return "(was read)";
}

Image noise(int width, int height, std::vector<std::string> channels) {
    Image image(width, height, std::move(channels));
    std::uint32_t state = 1;
    for (float& x : image.data) {
        state = state * 1664525u + 1013904223u;
        x     = float(state >> 8) / float(1u << 24);
    }
    return image;
}

/// A PNG header is checked by a CRC, so that a lie about the size needs a new one.
std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t crc = ~0u;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ ((crc & 1) ? 0xedb88320u : 0u);
    }
    return ~crc;
}
void put_big_endian(std::string& bytes, std::size_t at, std::uint32_t value) {
    for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(value >> (24 - 8 * k));
}
std::string png_claiming(std::string png, std::uint32_t width, std::uint32_t height) {
    put_big_endian(png, 16, width);
    put_big_endian(png, 20, height);
    put_big_endian(png, 29, crc32(std::string_view(png).substr(12, 17)));
    return png;
}

TEST_F(ImageIo, ExrKeepsChannelsMetadataAndEveryBit) {
    Image image    = noise(37, 21, {"R", "G", "B", "S.lamp", "S.sun", "N.x", "id.face"});
    image.data[5]  = std::numeric_limits<float>::quiet_NaN();
    image.data[6]  = kInfinity;
    image.data[7]  = -0.0f;
    image.data[8]  = 1e-42f;
    image.data[13] = 16777215;
    image.metadata = {{"umbra:scene", "court"}, {"umbra:command", "umbra render \"a b\" -o x"}, {"umbra:note", "üß"}};
    write_image(folder / "a.exr", image);

    const LoadedImage loaded = read_image(folder / "a.exr");
    EXPECT_EQ(loaded.encoding, Encoding::linear);
    ASSERT_EQ(loaded.image.width, 37);
    ASSERT_EQ(loaded.image.height, 21);
    for (const auto& [key, value] : image.metadata) EXPECT_EQ(loaded.image.metadata.at(key), value);
    std::vector<std::string> sorted = loaded.image.channels;
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted, (std::vector<std::string>{"B", "G", "N.x", "R", "S.lamp", "S.sun", "id.face"}));
    EXPECT_EQ(loaded.image.channels[0], "R");
    for (std::size_t c = 0; c < image.channels.size(); ++c) {
        const auto at      = std::find(loaded.image.channels.begin(), loaded.image.channels.end(), image.channels[c]);
        const auto in_file = std::size_t(at - loaded.image.channels.begin());
        for (std::size_t i = 0; i < image.pixels(); ++i)
            ASSERT_EQ(std::bit_cast<std::uint32_t>(loaded.image.at(i, in_file)),
                      std::bit_cast<std::uint32_t>(image.at(i, c)))
                << image.channels[c] << ' ' << i;
    }
}

TEST_F(ImageIo, ExrKeepsIntegersAndMatrices) {
    Image image                 = noise(37, 150, {"R", "G", "B", "Z", "h.x"});  // several strips
    const std::uint32_t large[] = {0, 1, (1u << 24) + 1, 4294967295u, 4294967294u, 305419896u};
    for (const char* name : {"A.first", "id.face", "k"})  // before, among and after the others by name
        for (std::size_t i = 0; i < image.pixels(); ++i)
            image.integers[name].push_back(large[(i + std::size_t(name[0])) % std::size(large)] ^ std::uint32_t(i));
    for (std::size_t k = 0; k < 16; ++k)
        image.matrices["worldToCamera"][k] = 0.1f * float(k), image.matrices["worldToNDC"][k] = -float(k);
    write_image(folder / "a.exr", image);

    const Image loaded = read_image(folder / "a.exr").image;
    EXPECT_EQ(loaded.integers, image.integers);
    EXPECT_EQ(loaded.matrices, image.matrices);
    ASSERT_EQ(loaded.channels.size(), image.channels.size());
    for (std::size_t c = 0; c < image.channels.size(); ++c) {
        const auto at = std::find(loaded.channels.begin(), loaded.channels.end(), image.channels[c]);
        ASSERT_NE(at, loaded.channels.end()) << image.channels[c];
        for (std::size_t i = 0; i < image.pixels(); ++i)
            ASSERT_EQ(loaded.at(i, std::size_t(at - loaded.channels.begin())), image.at(i, c))
                << image.channels[c] << ' ' << i;
    }
    const std::string bytes = bytes_of(folder / "a.exr");
    for (const char* attribute : {"worldToCamera", "worldToNDC"})  // under OpenEXR's names and type
        EXPECT_NE(bytes.find(attribute + std::string("\0m44f\0", 6)), std::string::npos) << attribute;

    image.integers["k"].pop_back();
    EXPECT_THROW(write_image(folder / "a.exr", image), std::logic_error);
}

using other_writers::part;
using other_writers::write_parts;

TEST_F(ImageIo, PartsArePutTogether) {
    write_parts(folder / "a.exr", {part("rgb", {"R", "G", "B"}, 0.25f), part("depth", {"Z"}, 7),
                                   part("spec", {"spec.R", "spec.G", "spec.B"}, 0.5f)});
    const Image exr = read_image(folder / "a.exr").image;
    EXPECT_EQ(exr.channels, (std::vector<std::string>{"R", "G", "B", "depth.Z", "spec.R", "spec.G", "spec.B"}));
    ASSERT_EQ(exr.data.size(), exr.pixels() * 7);
    for (std::size_t i = 0; i < exr.pixels(); ++i)
        for (std::size_t c = 0; c < 7; ++c) ASSERT_EQ(exr.at(i, c), c < 3 ? 0.25f : c == 3 ? 7 : 0.5f) << i << ' ' << c;

    write_parts(folder / "a.tif", {part("", {"R", "G", "B"}, 0.25f), part("", {"R", "G", "B"}, 0.75f)});
    const Image pages = read_image(folder / "a.tif").image;
    EXPECT_EQ(pages.channels, (std::vector<std::string>{"R", "G", "B", "2.R", "2.G", "2.B"}));
    EXPECT_EQ(pages.at(95, 5), 0.75f);
}

TEST_F(ImageIo, PartsThatDoNotFitAreRefusedByName) {
    const auto saying = [&](const char* name, const std::vector<other_writers::Part>& parts, bool mip = false) {
        write_parts(folder / name, parts, mip);
        std::string text = refusal(folder / name);
        EXPECT_EQ(text.find((folder / name).string() + ": "), 0u) << text;
        return text.substr((folder / name).string().size() + 2);
    };
    EXPECT_EQ(
        saying("a.tif", {part("", {"R", "G", "B"}, 0), part("", {"R", "G", "B"}, 0, 12, 8, OIIO::TypeDesc::UINT8)}),
        "part 2 is not as the first: one holds linear light, the other sRGB (parts of one kind are read)");
    auto small            = part("small", {"Z"}, 0, 6, 4);
    small.spec.full_width = 12, small.spec.full_height = 8;  // all parts have one display window
    EXPECT_EQ(saying("a.exr", {part("rgb", {"R", "G", "B"}, 0), small}),
              "part small is not as the first: sizes differ: 12x8 against 6x4 (parts of one size and place are read)");
    std::vector<other_writers::Part> levels{part("", {"R", "G", "B"}, 0, 16, 16), part("", {"R", "G", "B"}, 0, 8, 8)};
    for (other_writers::Part& level : levels) {
        level.spec.tile_width = level.spec.tile_height = 16;
        level.spec.attribute("textureformat", "Plain Texture");
    }
    EXPECT_EQ(saying("b.exr", levels, true), "has smaller copies of its pixels, mip levels (pictures are read)");
}

TEST_F(ImageIo, WhatAFileSaysOfItsColoursAndPlaceIsKept) {
    const auto said = [&](const char* name, const other_writers::Part& of) {
        write_parts(folder / name, {of});
        return read_image(folder / name).shown_as;
    };
    using Said       = std::map<std::string, std::string>;
    const auto plain = part("", {"R", "G", "B"}, 0.5f);
    EXPECT_EQ(said("plain.exr", plain), Said{});
    auto aces           = plain;
    const float xy[8]   = {0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f};
    const float srgb[8] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    aces.spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy);
    EXPECT_EQ(said("aces.exr", aces),
              (Said{{"colours", "chromaticities 0.7347 0.2653 0 1 0.0001 -0.077 0.3217 0.3377"}}));
    aces.spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), srgb);
    EXPECT_EQ(said("srgb.exr", aces), Said{});
    auto in_frame            = plain;
    in_frame.spec.full_width = 40, in_frame.spec.full_height = 30;
    EXPECT_EQ(said("frame.exr", in_frame), (Said{{"display windows", "40x30 from (0, 0)"}}));

    const auto bytes = part("", {"R", "G", "B"}, 0.5f, 12, 8, OIIO::TypeDesc::UINT8);
    EXPECT_EQ(said("plain.png", bytes), Said{});
    auto gamma = bytes;
    gamma.spec.attribute("oiio:ColorSpace", "Gamma1.8");
    gamma.spec.attribute("oiio:Gamma", 1.8f);
    EXPECT_EQ(said("gamma.png", gamma), (Said{{"colours", "Gamma1.8"}}));
    gamma.spec.attribute("oiio:ColorSpace", "linear");
    EXPECT_EQ(said("linear.png", gamma), (Said{{"colours", "linear"}}));
    auto turned = bytes;
    turned.spec.attribute("Orientation", 6);
    EXPECT_EQ(said("turned.tif", turned), (Said{{"orientations", "6 of EXIF"}}));
}

TEST_F(ImageIo, IntegersAloneAreFloatsAsWell) {
    Image image(3, 1, {});
    image.integers["id"] = {0, 4294967295u, 4294967294u};
    spread_integers(image);
    EXPECT_EQ(image.channels, std::vector<std::string>{"id"});
    EXPECT_EQ(image.data, (std::vector<float>{0, 1, 1}));
}

TEST(Layers, AreAllPicturesOfAnImage) {
    const auto names = [](std::vector<std::string> channels) {
        std::string text;
        for (const Layer& layer : layers(Image(1, 1, std::move(channels))))
            text += "[" + layer.name + " " + std::to_string(layer.channels[0]) + std::to_string(layer.channels[1]) +
                    std::to_string(layer.channels[2]) + "]";
        return text;
    };
    EXPECT_EQ(names({"R", "G", "B", "A"}), "[ 012]");
    EXPECT_EQ(names({"spec.B", "spec.G", "spec.R", "Z", "R", "G", "B"}), "[ 456][spec 210]");
    EXPECT_EQ(names({"left.a.R", "left.a.G", "left.a.B", "b.R", "b.G", "b.B"}), "[left.a 012][b 345]");
    EXPECT_EQ(names({"R", "G"}), "[R 000][G 111]");
    EXPECT_EQ(names({"S.lamp"}), "[S.lamp 000]");
}

TEST_F(ImageIo, PngRoundsToEightBitsAndKeepsMetadata) {
    Image image(5, 1, {"R", "G", "B"});
    image.data = {0, 1, 0.5f, -3, 7, std::numeric_limits<float>::quiet_NaN(), 0.25f, 0.2499f, 1e-3f, 0, 0, 0, 1, 1, 1};
    image.metadata = {{"umbra:method", "ray_traced:samples=64"}};
    write_image(folder / "a.png", image);
    const LoadedImage loaded = read_image(folder / "a.png");
    EXPECT_EQ(loaded.encoding, Encoding::srgb);
    EXPECT_EQ(loaded.image.channels, image.channels);
    EXPECT_EQ(loaded.image.metadata.at("umbra:method"), "ray_traced:samples=64");
    const std::vector<int> expected{0, 255, 128, 0, 255, 0, 64, 64, 0, 0, 0, 0, 255, 255, 255};
    for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_EQ(std::lround(255 * loaded.image.data[k]), expected[k]) << k;
}

TEST_F(ImageIo, PngTakesOneThreeOrFourChannels) {
    for (const auto& [channels, stored] : std::vector<std::pair<std::vector<std::string>, std::size_t>>{
             {{"S.lamp"}, 1}, {{"R", "G", "B", "S.lamp"}, 3}, {{"R", "G", "B", "A"}, 4}}) {
        const Image image = noise(9, 4, channels);
        write_image(folder / "a.png", image);
        const Image loaded = read_image(folder / "a.png").image;
        ASSERT_EQ(loaded.channels.size(), stored);
        for (std::size_t i = 0; i < image.pixels(); ++i)  // alpha is not multiplied in, neither way
            for (std::size_t c = 0; c < stored; ++c) EXPECT_NEAR(loaded.at(i, c), image.at(i, c), 0.5 / 255 + 1e-6);
    }
}

TEST_F(ImageIo, IntegersAreScaledWithOneRounding) {
    // OpenImageIO's own conversion to float is off by a bit for half of all bytes, so that 8 and 16 bits would differ.
    Image image(256, 1, {"Y"});
    for (std::size_t i = 0; i < 256; ++i) image.data[i] = float(i) / 255;
    write_image(folder / "a.png", image);
    EXPECT_EQ(read_image(folder / "a.png").image.data, image.data);
}

TEST_F(ImageIo, SameImageSameBytes) {
    const Image image = noise(64, 64, {"R", "G", "B"});
    for (const char* name : {"a.exr", "a.png"}) {
        write_image(folder / name, image);
        const std::string first = bytes_of(folder / name);
        write_image(folder / name, image);  // over the old one
        EXPECT_EQ(bytes_of(folder / name), first);
        const auto metadata = read_image(folder / name).image.metadata;
        const auto date     = metadata.find("DateTime");
        EXPECT_TRUE(date == metadata.end() || date->second.empty()) << date->second;  // other bytes a second later
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2);  // nothing partial is left
}

TEST_F(ImageIo, FailedWriteSaysWhyAndLeavesNothing) {
    const Image image = noise(4, 4, {"R", "G", "B"});
    fs::create_directories(folder / "taken.png" / "full");
    for (const char* name : {"taken.png", "missing/a.exr", "a.jpg", "a"}) {
        try {
            write_image(folder / name, image);
            ADD_FAILURE() << name << " was written";
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).find((folder / name).string() + ": cannot write image: "), 0u)
                << error.what();
        }
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST_F(ImageIo, RefusesWhatIsNoImageFile) {
    EXPECT_EQ(refusal(folder / "none.exr"), (folder / "none.exr").string() + ": no such file");
    EXPECT_NE(refusal(folder).find("is a folder"), std::string::npos);
    for (const char* name : {"a.exr", "a.png", "a.jpg", "a.tif", "a.hdr", "a"}) {
        for (const char* content : {"", "x", "this is no image at all, however one looks at it"}) {
            const std::string reason = refusal(write(name, content));
            EXPECT_EQ(reason.find((folder / name).string() + ": cannot read image: "), 0u) << reason;
            EXPECT_GT(reason.size(), (folder / name).string().size() + 30) << reason;
            EXPECT_EQ(reason.find('\n'), std::string::npos) << reason;
        }
    }
}

TEST_F(ImageIo, RefusesTruncatedFiles) {
    const Image image = noise(80, 60, {"R", "G", "B"});
    for (const char* name : {"a.exr", "a.png"}) {
        write_image(folder / name, image);
        const std::string whole = bytes_of(folder / name);
        for (const double share : {0.001, 0.01, 0.1, 0.5, 0.9, 0.98}) {
            const fs::path file      = write(name, whole.substr(0, std::size_t(share * double(whole.size()))));
            const std::string reason = refusal(file);
            EXPECT_EQ(reason.find(file.string() + ": cannot read image: "), 0u) << share << ' ' << reason;
        }
    }
}

TEST_F(ImageIo, RefusesHeadersThatLieAboutTheSize) {
    write_image(folder / "a.png", noise(8, 8, {"R", "G", "B"}));
    const std::string png = bytes_of(folder / "a.png");
    EXPECT_EQ(refusal(write("same.png", png_claiming(png, 8, 8))), "(was read)");
    // Beyond the limit; and within it, where the pixels run out at once.
    EXPECT_NE(refusal(write("huge.png", png_claiming(png, 900000, 900000))), "(was read)");
    EXPECT_NE(refusal(write("large.png", png_claiming(png, 16000, 16000))).find("cannot read image"),
              std::string::npos);
    EXPECT_NE(refusal(write("none.png", png_claiming(png, 0, 8))), "(was read)");

    write_image(folder / "a.exr", noise(8, 8, {"R", "G", "B"}));
    const std::string exr = bytes_of(folder / "a.exr");
    for (const std::int32_t corner : {16000, 40000, 2000000000, -5}) {
        std::string lie = exr;
        for (const char* name : {"dataWindow", "displayWindow"}) {
            // name 0, "box2i" 0, size 4 bytes, xmin ymin xmax ymax
            const std::size_t at = lie.find(name) + std::strlen(name) + 1 + 6 + 4;
            for (const std::size_t k : {8u, 12u}) std::memcpy(&lie[at + k], &corner, 4);
        }
        EXPECT_NE(refusal(write("lie.exr", lie)), "(was read)") << corner;
    }
}

TEST_F(ImageIo, RefusesChunksAndAttributesLongerThanTheFile) {
    Image image    = noise(8, 8, {"R", "G", "B"});
    image.metadata = {{"umbra:scene", "court"}};
    write_image(folder / "a.exr", image);
    std::string exr      = bytes_of(folder / "a.exr");
    const std::size_t at = exr.find("umbra:scene") + std::strlen("umbra:scene") + 1 + std::strlen("string") + 1;
    ASSERT_EQ(exr[at], 5);
    exr[at + 3] = 0x55;
    EXPECT_NE(refusal(write("lie.exr", exr)).find("attribute umbra:scene claims 1426063365 bytes"), std::string::npos);

    write_image(folder / "a.png", image);
    std::string png           = bytes_of(folder / "a.png");
    png[png.find("tEXt") - 4] = 0x55;
    EXPECT_NE(refusal(write("lie.png", png)).find("a chunk claims 14260633"), std::string::npos)
        << refusal(folder / "lie.png");
}

/// OpenEXR reads some attributes without regard to their length, and then takes the next bytes for another's: 600 bytes
/// made it take two gigabytes.
TEST_F(ImageIo, RefusesAttributesThatAreNoneOfTheirLength) {
    write_image(folder / "a.exr", noise(8, 8, {"R", "G", "B"}));
    const std::string exr = bytes_of(folder / "a.exr");
    // A file with an attribute before all others; a file whose attribute `name` has one byte more, which is 0.
    const auto with = [&](const std::string& attribute, const std::string& type, const std::string& data) {
        const auto size = static_cast<std::uint32_t>(data.size());
        std::string head(reinterpret_cast<const char*>(&size), 4);
        return exr.substr(0, 8) + attribute + '\0' + type + '\0' + head + data + exr.substr(8);
    };
    const auto longer = [&](const std::string& attribute, const std::string& type) {
        std::string file        = exr;
        const std::size_t place = file.find(attribute + '\0' + type + '\0') + attribute.size() + type.size() + 2;
        const auto length       = static_cast<unsigned char>(file[place]);
        file[place]             = static_cast<char>(length + 1);
        return file.insert(place + 4 + length, 1, '\0');
    };
    const auto answer = [&](const std::string& bytes) { return refusal(write("lie.exr", bytes)); };
    const std::string word("\xff\xff\xff\x0f", 4), two("\2\0\0\0", 4), one("\1\0\0\0", 4);

    EXPECT_EQ(answer(exr), "(was read)");
    EXPECT_NE(answer(longer("channels", "chlist")).find("attribute channels is not a chlist of"), std::string::npos);
    EXPECT_NE(answer(longer("lineOrder", "lineOrder")).find("claims 2 bytes, and a lineOrder has 1"),
              std::string::npos);
    EXPECT_NE(answer(longer("dataWindow", "box2i")).find("claims 17 bytes, and a box2i has 16"), std::string::npos);

    EXPECT_EQ(find_false_claim(write("true.exr", with("more", "stringvector", two + "ab" + one + "c"))), "");
    EXPECT_NE(answer(with("more", "stringvector", two + "ab" + word + "c")).find("not a stringvector"),
              std::string::npos);
    EXPECT_NE(answer(with("more", "stringvector", two + "ab" + "c")).find("not a stringvector"), std::string::npos);
    EXPECT_EQ(find_false_claim(write("true.exr", with("preview", "preview", one + two + "12345678"))), "");
    EXPECT_NE(answer(with("preview", "preview", two + two + "12345678")).find("not a preview"), std::string::npos);
    EXPECT_NE(answer(with("preview", "preview", one)).find("not a preview"), std::string::npos);
}

/// The second part's header is read as the first's is.
TEST_F(ImageIo, RefusesWhatALaterPartClaims) {
    write_image(folder / "a.exr", noise(8, 8, {"R", "G", "B"}));
    std::string exr = bytes_of(folder / "a.exr");
    exr[5]          = 0x10;  // several parts
    // The header ends with an empty name, after the last attribute.
    const std::string last = std::string("screenWindowWidth") + '\0' + "float" + '\0';
    const std::size_t end  = exr.find(last) + last.size() + 4 + 4;
    ASSERT_EQ(exr[end], 0);
    exr.insert(end + 1, std::string("name") + '\0' + "string" + '\0' + "\xff\xff\xff\x0f");
    EXPECT_NE(refusal(write("parts.exr", exr)).find("attribute name claims 268435455 bytes"), std::string::npos)
        << refusal(folder / "parts.exr");
}

TEST_F(ImageIo, SurvivesFlippedBytes) {
    // Any answer will do but a crash (the sanitizers watch).
    const Image image = noise(16, 16, {"R", "G", "B"});
    for (const char* name : {"a.exr", "a.png"}) {
        write_image(folder / name, image);
        const std::string whole = bytes_of(folder / name);
        for (std::size_t at = 0; at < whole.size(); at += at < 600 ? 5 : 61) {
            std::string broken       = whole;
            broken[at]               = static_cast<char>(broken[at] ^ 0x55);
            const std::string reason = refusal(write(name, broken));
            EXPECT_FALSE(reason.empty());
        }
    }
}

/// Pooled values of the reference implementation of FLIP 1.6: see tests/data/README.md.
struct FlipCase {
    const char* name;
    double mean, weighted_median, first_quartile, third_quartile, min, max;
};
class FlipReference : public testing::TestWithParam<FlipCase> {};

TEST_P(FlipReference, IsMet) {
    const FlipCase& expected = GetParam();
    const bool hdr           = std::string(expected.name) == "hdr_bright";
    const fs::path folder    = fs::path(UMBRA_TEST_DATA) / "flip";
    const auto load          = [&](const char* part) {
        return read_image(folder / (std::string(expected.name) + part + (hdr ? ".exr" : ".png"))).image;
    };
    const Image reference = load("_ref");
    const Image test      = load("_test");
    const Flip flip       = hdr ? flip_hdr(reference, test) : flip_ldr(reference, test);
    EXPECT_NEAR(flip.mean, expected.mean, 2e-5);
    EXPECT_NEAR(flip.weighted_median, expected.weighted_median, 2e-5);
    EXPECT_NEAR(flip.first_quartile, expected.first_quartile, 2e-5);
    EXPECT_NEAR(flip.third_quartile, expected.third_quartile, 2e-5);
    EXPECT_NEAR(flip.min, expected.min, 2e-5);
    EXPECT_NEAR(flip.max, expected.max, 2e-5);
    if (hdr) {
        EXPECT_NEAR(flip.start_exposure, -0.1710, 5e-5);
        EXPECT_NEAR(flip.stop_exposure, 2.8641, 5e-5);
        EXPECT_EQ(flip.exposures, 4);
        return;
    }
    const Image map = load("_map");
    double worst    = 0;
    for (std::size_t i = 0; i < flip.map.size(); ++i)
        worst = std::max(worst, std::abs(255.0 * flip.map[i] - 255.0 * map.at(i, 0)));
    EXPECT_LT(worst, 0.51);  // the map is rounded to 8 bits
}
INSTANTIATE_TEST_SUITE_P(
    Pairs, FlipReference,
    testing::Values(FlipCase{"shadow_map_size", 0.008591, 0.126565, 0.042153, 0.205649, 0, 0.372673},
                    FlipCase{"stencil_vs_pcf", 0.049035, 0.212030, 0.209136, 0.225190, 0, 0.570010},
                    FlipCase{"filter_kind", 0.052875, 0.174695, 0.124994, 0.195553, 0, 0.288104},
                    FlipCase{"grey_step", 0.054038, 0.298072, 0.193508, 0.334065, 0, 0.338895},
                    FlipCase{"odd_checker", 0.004925, 0.025729, 0.001681, 0.025736, 0.001579, 0.398275},
                    FlipCase{"black_white", 0.967384, 0.967388, 0.967388, 0.967388, 0.967388, 0.967388},
                    FlipCase{"hdr_bright", 0.019339, 0.260763, 0.093229, 0.488991, 0, 0.793282}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace umbra
