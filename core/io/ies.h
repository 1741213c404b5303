// Photometric files after IES LM-63. Internal to core.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/core/scene/photometry.h"

namespace umbra {

/// The table of a file after LM-63 of 1986, 1991, 1995 or 2002, of the photometric type A, B or C. Its intensities are
/// multiplied by the file's multiplier and ballast factor, by the ballast-lamp photometric factor unless the file says
/// that it is of 2002 or later, which reserve that number, and by the factor of TILT=INCLUDE for a luminaire that is
/// not tilted. Horizontal angles that end between 180 and 360 degrees are closed with those of 0. Keywords, lumens,
/// sizes and watts are not used. Forms that the format forbids and files have nevertheless are read with a sentence in
/// `warnings`: text behind the values, negative values (0), a single plane that is not at 0, no watts, a file of lamp
/// factors (TILT=FILE) that is not beside this one. Throws InputError with file, line and column.
[[nodiscard]] Photometry read_ies(const std::filesystem::path& file, std::vector<std::string>& warnings);

}  // namespace umbra
