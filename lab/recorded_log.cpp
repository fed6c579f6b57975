#include "lab/recorded_log.hpp"

#include "robot_client/sources/carmen_log.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace scanloom::lab {

std::string name_of_log(const std::string& path) {
    std::filesystem::path file = std::filesystem::path(path).filename();
    if (file.extension() == ".bz2" || file.extension() == ".gz") file = file.stem();
    std::string name = file.stem().string();
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    };
    std::ranges::replace_if(name, std::not_fn(is_plain), '_');
    return name;
}

Result<RecordedLog> read_recorded_log(const LogFiles& files) {
    RecordedLog recorded{.name = name_of_log(files.log)};
    auto relations = read_relations(files.relations); // first, because reading them takes no time
    if (!relations) return relations.error();
    recorded.relations = std::move(*relations);
    auto log = robot::CarmenLog::open(files.log, {.poses = Poses::kOdometry}, [](const robot::SkippedLine&) {});
    if (!log) return log.error();
    for (;;) {
        auto observation = log->next();
        if (!observation) return observation.error();
        if (!*observation) return recorded;
        recorded.scans.push_back(std::move(**observation));
    }
}

std::vector<robot::StampedPose> odometry_of(const RecordedLog& log) {
    std::vector<robot::StampedPose> poses;
    for (const auto& [sensor, scan] : log.scans) poses.push_back({*scan.odometry, scan.stamp});
    return poses;
}

Result<std::optional<robot::Observation>> LogReplay::next() {
    if (next_ == log_.scans.size()) return std::optional<robot::Observation>{};
    robot::Observation observation = log_.scans[next_++];
    if (poses_ == Poses::kNone) observation.scan.odometry.reset();
    return std::optional(std::move(observation));
}

} // namespace scanloom::lab
