// The pages of `umbra view` over HTTP: only for this machine, only for who knows the address.
//
// HTTP is cpp-httplib's (packaged by Debian as libcpp-httplib-dev): one library with threads, limits and time-outs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "umbra/bench/lab/budget.h"

namespace umbra {

struct ViewerOptions {
    std::filesystem::path scene;
    std::vector<std::string> methods{};  ///< as typed, checked; those that a page shows first, one or two
    int port = 0;                        ///< 0: any that is free
    Budget most{};                       ///< of a method, each time it runs
    std::size_t pages = 4;               ///< kept at one time, each with a scene of its own: the one that asked longest
                                         ///< ago goes first
};

/// Listens on 127.0.0.1. Every address begins with a random word, every request must name this host and, if it names an
/// origin, this one; nothing in a request becomes a file name. A wrong request is answered by a status and a sentence.
class ViewServer {
public:
    /// Loads the scene, so that a page finds it there. Throws InputError, and UsageError where the port is taken.
    explicit ViewServer(const ViewerOptions& options);
    ~ViewServer();

    [[nodiscard]] std::string address() const;  ///< "http://127.0.0.1:PORT/WORD/"
    void serve();                               ///< until stop()
    void stop();                                ///< from any thread

private:
    struct Pages;
    std::unique_ptr<Pages> pages_;
};

}  // namespace umbra
