#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/scan_filter.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/foxglove/mcap_writer.hpp"
#include "server/foxglove/robot_messages.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::foxglove {

/// Converts a session's log to an MCAP file for Foxglove, Lichtblick and readers of MCAP. Topics: /tf; for each robot
/// /ROBOT/pose, and /ROBOT/scan with _ID after it for sensors other than number 0; and /map, the occupancy at the end.
/// The log time of a message is the stamp of its scan; /map has that of the newest scan.
///
/// A scan that the maps leave out, because of its place or by an exclusion, has no transform and no pose; its frame is
/// unplaced_frame().
/// Threads: one at a time.
class LogRecording {
public:
    /// @param filter  decides which scans are integrated in the session's maps
    explicit LogRecording(ScanFilter filter) : filter_(std::move(filter)) {}

    /// Adds the log's next entry. Scans have their poses in the maps, as far as they are known.
    /// Errors: kMalformed if a scan's robot or sensor is unknown; kConflict if there are more topics than an MCAP file
    ///     can have, some 65,000.
    [[nodiscard]] Result<> add(const LogEntry& entry);

    /// Ends the file with the map.
    /// @param maps  of the session after the last entry
    /// A map that is empty, or larger than images of maps may be, is left out.
    void finish(const mapping::Snapshot& maps);

    /// Returns the bytes of the file that follow those returned before.
    [[nodiscard]] std::string take() { return file_.take(); }

private:
    struct Robot {
        std::string name;
        std::map<std::uint32_t, Sensor> sensors; // by Sensor::id
    };

    /// A scan that the maps show.
    struct PlacedScan {
        RobotAt at;
        const Sensor* sensor;       ///< that took it
        double half_duration = 0.0; ///< seconds
    };

    [[nodiscard]] Result<> add_scan(const ScanTaken& taken);
    [[nodiscard]] bool has_room() const noexcept;
    void write_transforms(const PlacedScan& scan, double after);
    void write(const std::string& topic, Message message, double stamp, const std::string& bytes);

    McapWriter file_;
    ScanFilter filter_;
    Revision revision_ = 0; // of the newest entry
    std::map<RobotIndex, Robot> robots_;
    std::map<RobotIndex, PlacedScan> newest_placed_;        // of each robot
    std::map<std::string, McapWriter::ChannelId> channels_; // by topic
    double newest_ = 0.0;                                   // seconds, the latest stamp
};

} // namespace scanloom::foxglove
