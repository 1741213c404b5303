// How much memory the machine has, for methods that bound what they hold.
#pragma once

namespace umbra {

/// Physical memory of this machine, bytes; > 0. Knows nothing of what other programs use, or of a container's limit.
[[nodiscard]] double machine_memory();

}  // namespace umbra
