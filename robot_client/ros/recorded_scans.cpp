#include "robot_client/ros/recorded_scans.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::robot {

RecordedScans::RecordedScans(std::string path, RecordingPlan plan, RecordingLosses losses,
                             std::unique_ptr<Recording> recording)
    : path_(std::move(path)), plan_(std::move(plan)), losses_(std::move(losses)), recording_(std::move(recording)) {}

Result<RecordedScans> RecordedScans::open(const std::filesystem::path& path, const RecordingOptions& options,
                                          const OnRead& on_read) {
    auto found = survey(path, on_read);
    if (!found) return found.error();
    auto plan = robot::plan(*found, options);
    if (!plan) return Error{plan.error().code, fmt::format("{}: {}", path.string(), plan.error().message)};
    auto recording = open_recording(path);
    if (!recording) return recording.error();
    return RecordedScans(path.string(), std::move(*plan), std::move(found->losses), std::move(*recording));
}

Error RecordedScans::changed() const {
    return {Errc::kConflict, fmt::format("{}: the file has changed since it was opened; start again", path_)};
}

Result<std::optional<Observation>> RecordedScans::next() {
    while (place_ < plan_.scan_count) {
        if (auto early = early_.extract(place_)) {
            ++place_;
            return std::optional(std::move(early.mapped()));
        }
        const auto message = recording_->next();
        if (!message) return message.error();
        if (!*message) return changed();
        const auto& topic = recording_->topics()[(*message)->topic];
        if (!is_laser(topic)) continue;
        if (scans_ >= plan_.scans.size()) return changed();
        const PlannedScan& planned = plan_.scans[scans_++];
        if (planned.place == PlannedScan::kUnused) continue;
        const auto laser = plan_.lasers.find(static_cast<std::uint32_t>((*message)->topic));
        if (laser == plan_.lasers.end()) return changed();
        auto observation = observe(topic, **message, planned, laser->second);
        if (!observation) return observation.error();
        early_.emplace(planned.place, std::move(*observation));
    }
    return std::optional<Observation>();
}

Result<Observation> RecordedScans::observe(const RecordedTopic& topic, const RecordedMessage& message,
                                           const PlannedScan& planned, const PlannedLaser& laser) {
    const auto decoded = decode_laser_scan(message.bytes, topic.encoding, topic.type);
    if (!decoded || !check_usable(*decoded)) return changed();
    const ScanPlace place{planned.pose, plan_.mounts[planned.mount]};
    return observer_.observe(*decoded, message.time, laser.id, topic.name, laser.meaning, place, plan_.poses);
}

std::string RecordedScans::remarks() const {
    return plan_.skipped.empty() ? std::string() : "skipped: " + skipped_text(plan_.skipped);
}

} // namespace scanloom::robot
