#pragma once

#include "server/mapping/snapshot.hpp"

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>

namespace scanloom::session {

/// The newest maps of a session: put here by its writer, read by everybody.
///
/// The writer may take them back for a moment, to fold into chunks that nobody looks at without copying them first.
/// Whoever asks then waits for the next ones, so that what was acknowledged before is always in what get() returns.
/// They are not taken back again before everybody who waited has them.
class Published {
public:
    /// The newest maps; null before the first set().
    /// Thread  any; waits for a set() where they were taken back.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> get() const {
        std::unique_lock lock(mutex_);
        ++waiting_;
        is_there_.wait(lock, [this] { return !taken_back_; });
        --waiting_;
        return maps_;
    }

    /// The same for threads that may not wait: null where they were taken back.
    /// Thread  any.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> try_get() const {
        const std::lock_guard lock(mutex_);
        return maps_;
    }

    /// Whether anybody waits for them.
    /// Thread  any.
    [[nodiscard]] bool is_waited_for() const {
        const std::lock_guard lock(mutex_);
        return waiting_ > 0;
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

    /// Puts others in the place of maps that were taken back; does nothing where they are there.
    /// Thread  the writer's.
    void fall_back_to(std::shared_ptr<const mapping::Snapshot> maps) noexcept {
        {
            const std::lock_guard lock(mutex_);
            if (!taken_back_) return;
            maps_.swap(maps);
            taken_back_ = false;
        }
        is_there_.notify_all();
    }

    /// Lets go of the maps, unless somebody else holds them or has waited for them and is still on the way.
    /// Post    when true: whoever asks waits until set(), which is to follow in about a millisecond.
    /// Thread  the writer's, which must not get() until then.
    [[nodiscard]] bool take_back() {
        std::shared_ptr<const mapping::Snapshot> last; // goes after the lock
        const std::lock_guard lock(mutex_);
        if (waiting_ > 0 || maps_.use_count() != 1)
            return false; // copies are made under the lock: nobody else can come by one
        last.swap(maps_);
        taken_back_ = true;
        return true;
    }

private:
    mutable std::mutex mutex_; // guards what follows, held for a copy only
    mutable std::condition_variable is_there_;
    std::shared_ptr<const mapping::Snapshot> maps_;
    bool taken_back_ = false;
    mutable std::size_t waiting_ = 0; // threads in get()
};

} // namespace scanloom::session
