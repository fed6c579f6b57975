#include "common/limits/semaphore.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace scanloom::limits {
namespace {

TEST(Semaphore, RefusesOneMoreUntilThePermitIsReleased) {
    const Semaphore semaphore(2);
    auto first = semaphore.try_acquire();
    const auto second = semaphore.try_acquire();
    EXPECT_TRUE(first && second);
    EXPECT_FALSE(semaphore.try_acquire());
    auto copy = first;
    first.reset();
    EXPECT_FALSE(semaphore.try_acquire()) << "the copy holds the permit";
    copy.reset();
    EXPECT_TRUE(semaphore.try_acquire());
}

TEST(Semaphore, MayBeOutlivedByItsPermits) {
    Semaphore::Permit permit;
    {
        const Semaphore semaphore(1);
        permit = semaphore.try_acquire();
    }
    permit.reset();
}

TEST(Semaphore, CopiesShareThePermits) {
    const Semaphore semaphore(1);
    const Semaphore copy = semaphore; // NOLINT(performance-unnecessary-copy-initialization)
    const auto permit = semaphore.try_acquire();
    EXPECT_FALSE(copy.try_acquire());
}

TEST(Semaphore, IsNeverHeldByMoreThreadsThanItHasPermits) {
    const Semaphore semaphore(3);
    std::atomic<int> held = 0;
    std::atomic<int> most = 0;
    {
        std::vector<std::jthread> threads;
        for (int n = 0; n < 6; ++n) {
            threads.emplace_back([&] {
                for (int round = 0; round < 2'000; ++round) {
                    const auto permit = semaphore.try_acquire();
                    if (!permit) continue;
                    const int now = ++held;
                    int seen = most;
                    while (now > seen && !most.compare_exchange_weak(seen, now)) {
                    }
                    --held;
                }
            });
        }
    }
    EXPECT_LE(most, 3);
    const auto again = semaphore.try_acquire();
    EXPECT_TRUE(again);
}

TEST(Semaphore, RefusedAttemptsDoNotHideAFreePermit) {
    for (int round = 0; round < 100; ++round) {
        const Semaphore semaphore(1);
        auto permit = semaphore.try_acquire();
        bool other_acquired = false;
        {
            const std::jthread other([&](const std::stop_token& stop) {
                while (!stop.stop_requested() && !other_acquired) other_acquired = semaphore.try_acquire() != nullptr;
            });
            for (int attempt = 0; attempt < 10'000 && permit; ++attempt) {
                permit.reset();
                permit = semaphore.try_acquire();
            }
        }
        ASSERT_TRUE(permit || other_acquired) << round;
    }
}

TEST(KeyedSemaphore, BoundsAllPermitsAndThoseOfOneKey) {
    const KeyedSemaphore<int> semaphore(3, 2);
    auto first = semaphore.try_acquire(1);
    const auto second = semaphore.try_acquire(1);
    EXPECT_TRUE(first && second);
    EXPECT_FALSE(semaphore.try_acquire(1)) << "two are taken for this key";
    auto other = semaphore.try_acquire(2);
    EXPECT_TRUE(other);
    EXPECT_FALSE(semaphore.try_acquire(3)) << "all three are taken";
    first.reset();
    EXPECT_TRUE(semaphore.try_acquire(1));
    other.reset();
    EXPECT_TRUE(semaphore.try_acquire(3));
}

TEST(KeyedSemaphore, MayBeOutlivedByItsPermits) {
    Semaphore::Permit permit;
    {
        const KeyedSemaphore<int> semaphore(1, 1);
        permit = semaphore.try_acquire(1);
    }
    EXPECT_TRUE(permit);
    permit.reset();
}

} // namespace
} // namespace scanloom::limits
