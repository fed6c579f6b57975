#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

namespace scanloom::limits {

/// Limits how many uses of a resource may exist at once. It never waits: a caller that gets no permit refuses its
/// request.
/// Threads: any thread.
class Semaphore {
public:
    /// Released with the last copy. May outlive the semaphore.
    using Permit = std::shared_ptr<const void>;

    /// Creates a semaphore with this many permits.
    explicit Semaphore(std::size_t permits) : free_(std::make_shared<std::atomic<std::size_t>>(permits)) {}

    /// Takes a permit.
    /// @return null if all permits are taken
    [[nodiscard]] Permit try_acquire() const {
        std::size_t free = *free_;
        do {
            if (free == 0) return nullptr;
        } while (!free_->compare_exchange_weak(free, free - 1));
        return {free_.get(), [free = free_](const void*) { free->fetch_add(1); }};
    }

private:
    std::shared_ptr<std::atomic<std::size_t>> free_;
};

/// Limits how many uses may exist at once, in total and for each key. It never waits.
/// Threads: any thread.
template <class Key>
class KeyedSemaphore {
public:
    using Permit = Semaphore::Permit; ///< held while the use lasts

    /// Creates a semaphore.
    /// @param permits          in total
    /// @param permits_per_key  for one key
    KeyedSemaphore(std::size_t permits, std::size_t permits_per_key)
        : acquired_(std::make_shared<Acquired>()), permits_(permits), permits_per_key_(permits_per_key) {}

    /// Takes a permit.
    /// @param key  whose use it is
    /// @return null if all permits, or those of the key, are taken
    [[nodiscard]] Permit try_acquire(const Key& key) const {
        {
            const std::lock_guard lock(acquired_->mutex);
            const auto known = acquired_->by_key.find(key);
            const std::size_t of_key = known == acquired_->by_key.end() ? 0 : known->second;
            if (acquired_->count >= permits_ || of_key >= permits_per_key_) return nullptr;
            ++acquired_->by_key[key];
            ++acquired_->count;
        }
        return {acquired_.get(), [acquired = acquired_, key](const void*) { acquired->release(key); }};
    }

private:
    struct Acquired {
        std::mutex mutex;
        std::map<Key, std::size_t> by_key;
        std::size_t count = 0;

        void release(const Key& key) {
            const std::lock_guard lock(mutex);
            const auto known = by_key.find(key);
            if (--known->second == 0) by_key.erase(known);
            --count;
        }
    };

    std::shared_ptr<Acquired> acquired_; // kept alive by the permits
    std::size_t permits_;
    std::size_t permits_per_key_;
};

} // namespace scanloom::limits
