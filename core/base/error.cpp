#include "umbra/core/base/error.h"

#include <new>

namespace umbra {

std::string current_message() {
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return "not enough memory";
    } catch (const std::exception& e) {
        return e.what();
    } catch (...) {
        return "an exception of unknown type";
    }
}

}  // namespace umbra
