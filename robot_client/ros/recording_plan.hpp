#pragma once

#include "common/error/error.hpp"
#include "common/scan/poses.hpp"
#include "robot_client/ros/recording_options.hpp"
#include "robot_client/ros/recording_survey.hpp"
#include "robot_client/sources/scan_order.hpp"

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A laser whose scans are sent.
struct PlannedLaser {
    std::uint32_t id = 0; ///< Sensor::id
    RangeMeaning meaning;
};

/// A scan that is sent, or not.
struct PlannedScan {
    static constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

    std::uint32_t place = kUnused; ///< among the scans in the order in which they are sent, from 0
    std::uint32_t mount = 0;       ///< index in RecordingPlan::mounts
    Pose2 pose;                    ///< of the robot in the fixed frame; unless poses are kNone
};

/// Which scans of a recording are sent, and with which poses.
struct RecordingPlan {
    Poses poses = Poses::kNone;
    std::string base_frame;                       ///< of the robot
    std::string fixed_frame;                      ///< that poses are in; empty if they are kNone
    std::string odom_topic;                       ///< that poses come from; empty: from transforms
    std::map<std::uint32_t, PlannedLaser> lasers; ///< by topic
    std::vector<LaserMount> mounts;
    std::vector<PlannedScan> scans; ///< by RecordingSurvey::scans
    std::uint32_t scan_count = 0;   ///< that are sent
    StampReport stamps;
    std::map<std::string, std::uint64_t> skipped; ///< scans that are not sent, by the reason
    std::vector<std::string> notes;               ///< what people should know: sentences
    std::string fingerprint;                      ///< equal for equal scans and poses
};

/// Returns the counts of scans that are not sent with their reasons, for people.
[[nodiscard]] std::string skipped_text(const std::map<std::string, std::uint64_t>& skipped);

/// Decides which lasers, frames and poses are used (see choose_lasers()), and where each scan was taken.
/// @param found  its transforms are used up
/// Errors: those of choose_lasers(); kNotFound if no scan can be sent.
[[nodiscard]] Result<RecordingPlan> plan(RecordingSurvey& found, const RecordingOptions& options);

} // namespace scanloom::robot
