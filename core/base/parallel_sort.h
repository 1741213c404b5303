// std::sort from many threads.
#pragma once

#include <tbb/parallel_sort.h>

#include <functional>

#include "umbra/core/base/parallel.h"

namespace umbra {

template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
    parallel_ranges(1, 1, [&](std::size_t, std::size_t) { tbb::parallel_sort(begin, end, less); });
}

}  // namespace umbra
