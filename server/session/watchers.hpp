#pragma once

#include <memory>
#include <mutex>
#include <vector>

namespace scanloom::session {

/// Interface that is notified when the visible state of a session has changed: its maps, the links of its robots, its
/// closing or failure, or data that other components keep about the session.
class Watcher {
public:
    virtual ~Watcher() = default;

    /// Called after a change, possibly often, on the session's strand or on any other thread. Must not block.
    virtual void on_changed() noexcept = 0;
};

/// The watchers of a session, held by weak pointers.
///
/// Their number is not limited here: the callers that admit watchers limit it.
/// Cost: one call of on_changed() per watcher and notification.
/// Threads: any thread.
class Watchers {
public:
    void add(std::weak_ptr<Watcher> watcher) {
        const std::lock_guard lock(mutex_);
        forget_the_gone();
        watchers_.push_back(std::move(watcher));
    }

    /// Calls on_changed() of each watcher.
    void tell() {
        const std::lock_guard lock(mutex_);
        bool any_gone = false;
        for (const auto& watcher : watchers_) {
            const auto present = watcher.lock();
            if (present) present->on_changed();
            any_gone = any_gone || !present;
        }
        if (any_gone) forget_the_gone();
    }

private:
    void forget_the_gone() {
        std::erase_if(watchers_, [](const auto& watcher) { return watcher.expired(); });
    }

    std::mutex mutex_;
    std::vector<std::weak_ptr<Watcher>> watchers_;
};

} // namespace scanloom::session
