#pragma once

#include "robot_client/sources/carmen_log.hpp"

namespace scanloom::robot {

/// A whole CARMEN log in memory.
struct WholeLog {
    std::vector<Observation> observations;
    std::size_t skipped_lines = 0;
    std::string fingerprint;
    StampReport stamps;
};

inline Result<WholeLog> read_whole_log(const std::filesystem::path& path, const CarmenOptions& options,
                                       const std::function<void(const SkippedLine&)>& report) {
    auto log = CarmenLog::open(path, options, report);
    if (!log) return log.error();
    WholeLog whole{{}, log->skipped_lines(), log->fingerprint(), log->stamps()};
    for (;;) {
        auto observation = log->next();
        if (!observation) return observation.error();
        if (!*observation) return whole;
        whole.observations.push_back(std::move(**observation));
    }
}

} // namespace scanloom::robot
