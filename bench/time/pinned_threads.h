// Threads that stay on their processors while times are measured.
#pragma once

#include <memory>

namespace umbra {

/// While it lives, the calling thread and the threads that work for it stay on one processor each, of those that the
/// process may use; afterwards they may move again. A system that refuses leaves them as they are. One at a time.
class PinnedThreads {
public:
    PinnedThreads();
    ~PinnedThreads();
    PinnedThreads(const PinnedThreads&)            = delete;
    PinnedThreads& operator=(const PinnedThreads&) = delete;
    /// Whether the calling thread is on one processor.
    [[nodiscard]] bool pinned() const;

private:
    class Observer;
    std::unique_ptr<Observer> observer_;
};

}  // namespace umbra
