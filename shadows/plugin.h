// A method in a shared library: UMBRA_PLUGIN(NAME) at the end of its file, outside of namespaces, and the file's path
// in --plugin of a command, or in the environment variable UMBRA_PLUGINS (several with ':' between).
//
// A plugin is C++ and is compiled with the program's own compiler, options and headers: the stamp refuses others. It is
// code that runs in the program, with all of its rights.
#pragma once

#include <string>
#include <string_view>

#include "umbra/shadows/method.h"

namespace umbra {

/// The compiler and the sizes of the contract's types, which both sides must have in common.
struct PluginStamp {
    std::string_view compiler = __VERSION__;
    std::size_t sizes[6]      = {sizeof(MethodInfo), sizeof(Parameter),  sizeof(PointBatch),
                                 sizeof(Scene),      sizeof(SceneFacts), sizeof(Visibility)};
    [[nodiscard]] bool operator==(const PluginStamp&) const = default;
};

/// Loads a plugin and adds its method; before other threads look at the list. Throws InputError: the file, what was found.
void add_plugin(const std::string& file);

/// The file that the method came from; empty for those of methods.def.
[[nodiscard]] std::string plugin_file(const MethodInfo& method);

}  // namespace umbra

#define UMBRA_PLUGIN(method)                                                              \
    extern "C" const umbra::MethodInfo* umbra_plugin(const umbra::PluginStamp& program) { \
        return program == umbra::PluginStamp{} ? &umbra::method : nullptr;                \
    }
