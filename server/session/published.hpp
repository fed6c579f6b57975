#pragma once

#include "server/mapping/snapshot.hpp"

#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>

namespace scanloom::session {

/// The newest maps of a session: put here by its writer, read by everybody.
///
/// The writer may take them back for a moment, to fold into chunks that nobody looks at without copying them first.
/// Whoever asks then waits for the next ones, so that what was acknowledged before is always in what get() returns.
class Published {
public:
    /// The newest maps; null before the first set().
    /// Thread  any; waits for a set() where they were taken back.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> get() const {
        std::unique_lock lock(mutex_);
        is_there_.wait(lock, [this] { return !taken_back_; });
        return maps_;
    }

    /// Thread  the writer's.
    void set(std::shared_ptr<const mapping::Snapshot> maps) {
        {
            const std::lock_guard lock(mutex_);
            maps_.swap(maps);
            taken_back_ = false;
        }
        is_there_.notify_all();
    }

    /// Lets go of the maps, unless somebody else holds them.
    /// Post    when true: whoever asks waits until set(), which is to follow in about a millisecond.
    /// Thread  the writer's, which must not get() until then.
    [[nodiscard]] bool take_back() {
        std::shared_ptr<const mapping::Snapshot> last; // goes after the lock
        const std::lock_guard lock(mutex_);
        if (maps_.use_count() != 1) return false; // copies are made under the lock: nobody else can come by one
        last.swap(maps_);
        taken_back_ = true;
        return true;
    }

private:
    mutable std::mutex mutex_; // guards what follows, held for a copy only
    mutable std::condition_variable is_there_;
    std::shared_ptr<const mapping::Snapshot> maps_;
    bool taken_back_ = false;
};

} // namespace scanloom::session
