#pragma once

#include <memory>
#include <mutex>
#include <vector>

namespace scanloom::session {

/// Wants to know when a session has something new to show: maps, links of robots, its own end, or what others keep
/// about it.
class Watcher {
public:
    virtual ~Watcher() = default;

    /// Look again when you have time. Called on the session's strand or on any thread, perhaps often: hand over, do not
    /// block, do not throw.
    virtual void on_changed() noexcept = 0;
};

/// Who watches a session. They are not kept alive, and what they show of it is nobody's business here.
/// Cost    of telling: one call for each, whatever it has missed. How many there may be is bounded by who lets them in.
/// Thread  any.
class Watchers {
public:
    void add(std::weak_ptr<Watcher> watcher) {
        const std::lock_guard lock(mutex_);
        forget_the_gone();
        watchers_.push_back(std::move(watcher));
    }

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
