// How much memory the machine has, for methods that bound the memory they hold; and the way of memory that they free.
#pragma once

namespace umbra {

/// Physical memory of this machine, bytes; > 0. Leaves out the use by other programs and a container's limit.
[[nodiscard]] double machine_memory();

/// The most that this process may hold, bytes: the least of the machine's memory, the limits of its control groups and
/// its limit of address space.
[[nodiscard]] double usable_memory();

/// The limit of address space alone (ulimit -v), bytes; infinite where there is none. Threads and libraries reserve
/// more of it than they use.
[[nodiscard]] double address_space_limit();

/// From now on, freed blocks of up to 256 MB are kept for the next allocation, up to 1 GB in one piece, where the C
/// library otherwise returns them: the system would clear every page again, which takes as long as a
/// third of a fast method's pass. For the start of a program. Does nothing where the C library is not GNU's.
void keep_freed_memory();

}  // namespace umbra
