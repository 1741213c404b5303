// MTL, the material files of Wavefront OBJ. Internal to core.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "umbra/core/scene/materials.h"

namespace umbra {

/// Adds the materials of one file by name; those of the same name are replaced. Throws InputError.
void read_mtl(const std::filesystem::path& file, std::map<std::string, Material, std::less<>>& materials,
              std::vector<std::string>& warnings);

}  // namespace umbra
