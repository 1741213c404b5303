// The table of functions that the library of image files hands to core, which loads it when the first file is read or
// written: OpenImageIO brings 250 libraries, which take 0.4 s of a start.
#pragma once

#include "umbra/core/image/image_io.h"

namespace umbra {

/// The functions of image_io.h, exported by the library as `umbra_image_library`.
struct ImageLibrary {
    decltype(&layout_differences) differences;
    decltype(&read_image) read;
    decltype(&write_image) write;
    decltype(&png_bytes) png;
};

}  // namespace umbra
