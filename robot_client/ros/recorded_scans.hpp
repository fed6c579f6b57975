#pragma once

#include "robot_client/ros/recording_plan.hpp"
#include "robot_client/ros/scan_observer.hpp"
#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// A source of the scans in a recording of ROS: a ROS 1 bag, an MCAP file or a rosbag2 database.
///
/// The file is read twice: open() finds topics, transforms and the order of scans, next() reads the scans as they are
/// needed. Memory: some 70 bytes for each scan, 100 for each transform between a laser and a fixed frame until open()
/// returns, one chunk of the file, and the scans that precede earlier-sent ones in the file.
class RecordedScans final : public Source {
public:
    /// Reads the recording once.
    /// @param on_read  called after each message
    /// Errors: those of survey() and plan().
    [[nodiscard]] static Result<RecordedScans> open(const std::filesystem::path& path, const RecordingOptions& options,
                                                    const OnRead& on_read = {});

    /// Errors: those of open_recording() and Recording::next(); kConflict if the file has changed since open().
    [[nodiscard]] Result<std::optional<Observation>> next() override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return plan_.scan_count; }
    [[nodiscard]] std::string remarks() const override;

    /// Returns which scans are sent.
    [[nodiscard]] const RecordingPlan& plan() const noexcept { return plan_; }
    /// Returns what open() could not read.
    [[nodiscard]] const RecordingLosses& losses() const noexcept { return losses_; }

private:
    RecordedScans(std::string path, RecordingPlan plan, RecordingLosses losses, std::unique_ptr<Recording> recording);

    [[nodiscard]] Error changed() const;
    [[nodiscard]] Result<Observation> observe(const RecordedTopic& topic, const RecordedMessage& message,
                                              const PlannedScan& planned, const PlannedLaser& laser);

    std::string path_;
    RecordingPlan plan_;
    RecordingLosses losses_;
    std::unique_ptr<Recording> recording_;
    std::size_t scans_ = 0;                      // messages of lasers that were read
    std::uint32_t place_ = 0;                    // of the next scan
    std::map<std::uint32_t, Observation> early_; // read before they are sent, by place
    ScanObserver observer_;
};

} // namespace scanloom::robot
