// Image files that our own writer does not write, by OpenImageIO itself: several parts, and what files say of
// themselves.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace umbra::other_writers {

/// A part of a file, every value of it `value`.
struct Part {
    OIIO::ImageSpec spec;
    float value = 0;
};

inline Part part(const std::string& name, std::vector<std::string> channels, float value, int width = 12,
                 int height = 8, OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT) {
    Part p{OIIO::ImageSpec(width, height, static_cast<int>(channels.size()), type), value};
    p.spec.channelnames = std::move(channels);
    if (!name.empty()) p.spec.attribute("oiio:subimagename", name);
    return p;
}

/// `mip` writes all but the first as its mip levels.
inline void write_parts(const std::filesystem::path& file, const std::vector<Part>& parts, bool mip = false) {
    auto output = OIIO::ImageOutput::create(file.string());
    if (!output) throw std::runtime_error(OIIO::geterror());
    const auto check = [&](bool done) {
        if (!done) throw std::runtime_error(file.string() + ": " + output->geterror());
    };
    std::vector<OIIO::ImageSpec> specs;
    for (const Part& p : parts) specs.push_back(p.spec);
    const bool declared = !mip && output->supports("multiimage") && file.extension() == ".exr" && parts.size() > 1;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (k == 0)
            check(declared ? output->open(file.string(), static_cast<int>(specs.size()), specs.data())
                           : output->open(file.string(), specs[0]));
        else
            check(output->open(file.string(), specs[k],
                               mip ? OIIO::ImageOutput::AppendMIPLevel : OIIO::ImageOutput::AppendSubimage));
        const std::vector<float> values(specs[k].image_pixels() * static_cast<std::size_t>(specs[k].nchannels),
                                        parts[k].value);
        check(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    }
    check(output->close());
}

}  // namespace umbra::other_writers
