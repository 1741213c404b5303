// Vectors whose elements are not set before they are written: clearing some megabytes takes one thread as long as two
// take to fill them.
#pragma once

#include <memory>
#include <vector>

#include <boost/core/noinit_adaptor.hpp>

namespace umbra {

/// As std::vector, but numbers that resize() adds have no value until one is written.
template <class T>
using RawVector = std::vector<T, boost::noinit_adaptor<std::allocator<T>>>;

}  // namespace umbra
