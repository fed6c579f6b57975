#pragma once

#include "core/localization/session_poses.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace scanloom::sessions {

/// What the loop searches of all sessions did since the start; see slam::LoopFigures.
/// Threads: any thread.
struct LoopCounters {
    static constexpr auto kJumpBounds = slam::LoopFigures::kJumpBounds; ///< metres

    std::atomic<std::uint64_t> matches = 0;
    std::atomic<std::uint64_t> disagreeing = 0;
    std::atomic<std::uint64_t> undetermined = 0;
    std::atomic<std::uint64_t> stretches_refused = 0;
    std::atomic<double> jump_sum = 0.0;                                     ///< metres
    std::array<std::atomic<std::uint64_t>, kJumpBounds.size() + 1> jumps{}; ///< by size; the last are beyond all bounds

    /// Adds what a search did between two moments.
    /// @param before  its figures at the first moment
    /// @param now     its figures at the second moment
    void add(const slam::LoopFigures& before, const slam::LoopFigures& now) {
        matches += now.matches - before.matches;
        disagreeing += now.disagreeing - before.disagreeing;
        undetermined += now.undetermined - before.undetermined;
        stretches_refused +=
            (now.stretch_tests - now.stretches_accepted) - (before.stretch_tests - before.stretches_accepted);
        jump_sum += now.jump_sum - before.jump_sum;
        for (std::size_t n = 0; n < jumps.size(); ++n) jumps[n] += now.jumps[n] - before.jumps[n];
    }
};

} // namespace scanloom::sessions
