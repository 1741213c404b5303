// How much memory the machine has, for methods that bound what they hold.
#pragma once

namespace umbra {

/// Physical memory of this machine, bytes; > 0. Knows nothing of what other programs use, or of a container's limit.
[[nodiscard]] double machine_memory();

/// What this process may hold in all, bytes: the least of the machine's memory, the limits of its control groups and
/// its limit of address space.
[[nodiscard]] double usable_memory();

/// The limit of address space alone (ulimit -v), bytes; infinite where there is none. Threads and libraries reserve
/// more of it than they use.
[[nodiscard]] double address_space_limit();

}  // namespace umbra
