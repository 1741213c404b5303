#include "umbra/core/image/image_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <stdexcept>

namespace umbra {
namespace {

const ImageLibrary& library() {
    static const ImageLibrary& table = []() -> const ImageLibrary& {
        std::string reasons;
        // Where it was built; where the loader looks, of an installed program.
        for (const char* file : {UMBRA_IMAGES_FOLDER UMBRA_IMAGES, UMBRA_IMAGES}) {
            void* const loaded = dlopen(file, RTLD_LAZY | RTLD_LOCAL);  // for the life of the process
            if (loaded == nullptr) {
                reasons += fmt::format("\n  {}", dlerror());
            } else if (const void* const found = dlsym(loaded, "umbra_image_library")) {
                return *static_cast<const ImageLibrary*>(found);
            } else {
                reasons += fmt::format("\n  {}: not a library of this program", file);
            }
        }
        throw std::runtime_error("the library of image files cannot be loaded, expected it built or installed:" +
                                 reasons);
    }();
    return table;
}

}  // namespace

std::vector<std::string> layout_differences(const LoadedImage& a, const LoadedImage& b) {
    return library().differences(a, b);
}

LoadedImage read_image(const std::filesystem::path& file) { return library().read(file); }

void write_image(const std::filesystem::path& file, const Image& image) { library().write(file, image); }

std::string png_bytes(const Image& image) { return library().png(image); }

}  // namespace umbra
