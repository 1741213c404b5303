// Files that a fuzz target writes and reads again and again.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <map>
#include <stdexcept>
#include <string>

#include "umbra/core/base/error.h"
#include "umbra/tests/fuzz/targets.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {

/// The folder that all runs of this process write their file to.
inline const TemporaryFolder& fuzz_folder() {
    static const TemporaryFolder all;
    return all;
}

/// Makes `bytes` all that the file `name` of the folder holds. The file stays open: opening and removing one takes
/// longer than many a run.
inline const std::filesystem::path& rewrite(const std::string& name, Bytes bytes) {
    struct File {
        std::filesystem::path path;
        int handle = -1;
    };
    static std::map<std::string, File> files;
    File& file = files[name];
    if (file.handle < 0) {
        file.path   = fuzz_folder().write(name, "");
        file.handle = ::open(file.path.c_str(), O_WRONLY | O_CLOEXEC);
    }
    const auto size = static_cast<::ssize_t>(bytes.size());
    if (::pwrite(file.handle, bytes.data(), bytes.size(), 0) != size || ::ftruncate(file.handle, size) != 0)
        throw std::runtime_error("cannot write " + file.path.string());
    return file.path;
}

/// A file may be refused: that is no fault.
template <class Read>
void read_or_refuse(const Read& read) {
    try {
        read();
    } catch (const InputError&) {
        return;
    } catch (const UsageError&) {
        return;
    }
}

}  // namespace umbra
