#pragma once

#include "core/mapping/snapshot.hpp"

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

namespace scanloom::sessions {

/// The newest maps of a session, written by one thread and read by many.
///
/// The writer may withdraw the maps for a moment to change chunks in place, without a copy, while no reader holds them.
/// Readers then wait for the next maps, so the result of get() always contains the scans that were acknowledged before
/// the call. The maps are not withdrawn again until all waiting readers have received them.
class PublishedMaps {
public:
    /// Returns the newest maps; null before the first set(). Waits for the next set() while the maps are withdrawn.
    /// Threads: any thread that may block for about a millisecond.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> get() const {
        std::unique_lock lock(mutex_);
        ++waiting_;
        published_.wait(lock, [this] { return !withdrawn_; });
        --waiting_;
        return maps_;
    }

    /// Returns the newest maps; null before the first set() or while the maps are withdrawn. Does not wait.
    /// Threads: any thread.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> try_get() const {
        const std::lock_guard lock(mutex_);
        return maps_;
    }

    /// Returns whether a thread waits in get().
    /// Threads: any thread.
    [[nodiscard]] bool is_waited_for() const {
        const std::lock_guard lock(mutex_);
        return waiting_ > 0;
    }

    /// Publishes maps.
    /// Threads: the writer's.
    void set(std::shared_ptr<const mapping::Snapshot> maps) {
        {
            const std::lock_guard lock(mutex_);
            maps_.swap(maps);
            withdrawn_ = false;
        }
        published_.notify_all();
    }

    /// Publishes `maps` if the maps are withdrawn; otherwise does nothing.
    /// Threads: the writer's.
    void fall_back_to(std::shared_ptr<const mapping::Snapshot> maps) noexcept {
        {
            const std::lock_guard lock(mutex_);
            if (!withdrawn_) return;
            maps_.swap(maps);
            withdrawn_ = false;
        }
        published_.notify_all();
    }

    /// Withdraws the maps and releases them, unless a reader holds them or still waits in get().
    ///
    /// After a return of true, get() waits until set() or fall_back_to(), which must follow within about a millisecond.
    /// The writer must not call get() until then.
    /// @return whether the maps were withdrawn
    /// Threads: the writer's.
    [[nodiscard]] bool withdraw() {
        std::shared_ptr<const mapping::Snapshot> last; // destroyed after the lock is released
        const std::lock_guard lock(mutex_);
        if (waiting_ > 0 || maps_.use_count() != 1)
            return false; // readers copy the pointer under the lock, so the count cannot rise here
        last.swap(maps_);
        withdrawn_ = true;
        return true;
    }

private:
    mutable std::mutex mutex_; // guards the members below; held briefly
    mutable std::condition_variable published_;
    std::shared_ptr<const mapping::Snapshot> maps_;
    bool withdrawn_ = false;
    mutable std::size_t waiting_ = 0; // threads in get()
};

/// Remembers mapping::main_bounds_of() the newest maps.
/// Threads: any thread.
class MainBounds {
public:
    /// Returns mapping::main_bounds_of(maps).
    /// Cost: a few milliseconds for the first call at each revision.
    [[nodiscard]] grid::CellBox of(const mapping::Snapshot& maps) const {
        const std::lock_guard lock(mutex_);
        if (at_ != maps.revision) {
            bounds_ = mapping::main_bounds_of(maps);
            at_ = maps.revision;
        }
        return bounds_;
    }

private:
    mutable std::mutex mutex_; // guards the members below
    mutable grid::CellBox bounds_;
    mutable std::optional<Revision> at_;
};

} // namespace scanloom::sessions
