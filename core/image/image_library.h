// The functions of image_io.h from a library that is loaded when the first of them is called: OpenImageIO brings 250
// libraries, which cost a process 0.4 s at its start. For our programs; others link umbra::image_io.
#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "umbra/core/image/image_io.h"

namespace umbra {

/// The table that the library exports as `umbra_image_library`.
struct ImageLibrary {
    decltype(&layout_differences) differences;
    decltype(&read_image) read;
    decltype(&write_image) write;
    decltype(&png_bytes) png;
};

/// Loads the library on a thread of its own, so that it is there when the first file is read or written. A failure is
/// told by the functions that need it, which throw std::runtime_error, and not by the future.
[[nodiscard]] std::future<void> begin_loading_images();

}  // namespace umbra
