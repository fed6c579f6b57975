#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::bench {

/// A part of the work, and functions that do it.
struct Stage {
    std::string name;
    std::vector<std::string_view> functions; ///< parts of their names with namespaces
};

/// Takes samples of this thread's call stack while it exists, by a signal of a timer of CPU time, as a profiler does:
/// the measured code needs no timers. One object at a time.
class StageSampler {
public:
    static constexpr std::size_t kSamplesMax = 100'000;

    StageSampler();
    ~StageSampler();
    StageSampler(const StageSampler&) = delete;
    StageSampler& operator=(const StageSampler&) = delete;

    /// Ends the sampling, and returns the share of each stage in the samples, and that of everything else at the end. A
    /// sample counts for the innermost function that a stage names. The program must export its symbols.
    [[nodiscard]] std::vector<std::pair<std::string, double>> shares(const std::vector<Stage>& stages);
};

} // namespace scanloom::bench
