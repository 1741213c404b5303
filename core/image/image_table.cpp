// Exported by the library that image_library.cpp loads.
#include "umbra/core/image/image_library.h"

extern "C" __attribute__((visibility("default"))) const umbra::ImageLibrary umbra_image_library = {
    umbra::layout_differences, umbra::read_image, umbra::write_image, umbra::png_bytes};
