#pragma once

#include "server/store/shared_sessions.hpp"
#include "tests/support/log_reading.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <string>
#include <thread>

namespace scanloom::store {

/// Lets two servers take the same session at the same time, again and again, and expects that the one that loses it
/// writes nothing.
inline void race_for_sessions(ScanLog& one, ScanLog& other, int races) {
    const std::array logs{&one, &other};
    std::atomic<int> won = 0;
    for (int race = 0; race < races; ++race) {
        const auto session = one.create_session("").value();
        ASSERT_TRUE(one.shared()->disown(session));
        std::array<std::jthread, 2> threads;
        for (std::size_t n = 0; n < 2; ++n) {
            threads[n] = std::jthread([&, n] {
                if (!own(*logs[n], session)) return;
                ++won;
                EXPECT_TRUE(append_and_wait(*logs[n], session, 1, {std::to_string(n)}));
            });
        }
        for (auto& thread : threads) thread.join();
        EXPECT_THAT(entries_after(one, session, 0).value(), testing::SizeIs(1));
    }
    EXPECT_EQ(won, races);
}

} // namespace scanloom::store
