#include "server/session/patient_mutex.hpp"

#include <gtest/gtest.h>

#include <array>
#include <latch>
#include <thread>

namespace scanloom::session {
namespace {

using namespace std::chrono_literals;

TEST(PatientMutex, HasOneOwnerAtATime) {
    PatientMutex mutex;
    std::unique_lock first(mutex, 0ms);
    EXPECT_TRUE(first.owns_lock());
    EXPECT_FALSE(std::unique_lock(mutex, 0ms).owns_lock());
    EXPECT_FALSE(std::unique_lock(mutex, 1ms).owns_lock());
    first.unlock();
    EXPECT_TRUE(std::unique_lock(mutex, 0ms).owns_lock());
    EXPECT_TRUE(std::unique_lock(mutex, 0ms).owns_lock()) << "the previous owner released it";
}

TEST(PatientMutex, WaitingThreadGetsItWhenReleased) {
    PatientMutex mutex;
    std::unique_lock first(mutex, 0ms);
    std::latch begun(2);
    std::array<bool, 2> had{};
    std::array<std::jthread, 2> waiting;
    for (std::size_t n = 0; n < waiting.size(); ++n) {
        waiting[n] = std::jthread([&, n] {
            begun.count_down();
            had[n] = std::unique_lock(mutex, 1h).owns_lock();
        });
    }
    begun.wait();
    first.unlock();
    for (auto& thread : waiting) thread.join();
    EXPECT_TRUE(had[0] && had[1]);
}

TEST(PatientMutex, ExcludesOtherThreads) {
    constexpr int kTimes = 2'000;
    PatientMutex mutex;
    int count = 0; // ThreadSanitizer detects threads that are not excluded
    {
        std::array<std::jthread, 4> threads;
        for (auto& thread : threads) {
            thread = std::jthread([&] {
                for (int n = 0; n < kTimes; ++n) {
                    const std::unique_lock lock(mutex, 1h);
                    ++count;
                }
            });
        }
    }
    EXPECT_EQ(count, 4 * kTimes);
}

} // namespace
} // namespace scanloom::session
