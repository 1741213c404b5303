#include "umbra/bench/run/scene_beside.h"

#include <fmt/format.h>

#include "umbra/core/base/error.h"

namespace umbra {

std::filesystem::path scene_beside(const Field& name, const std::filesystem::path& file, const FindScene& find) {
    const std::filesystem::path beside = file.parent_path() / name.required_text();
    try {
        return std::filesystem::is_regular_file(beside) ? beside : find(name.text());
    } catch (const UsageError& e) {
        name.refuse(fmt::format("a scene, or a file beside this one ({})", e.what()));
    }
}

}  // namespace umbra
