#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/scan_filter.hpp"

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::exchange {

/// A session's log as a CARMEN log: a comment at its head, then a ROBOTLASER1 line for each scan, in the order of the
/// log. Replayed into a session of the same settings it gives the same maps, bit for bit.
///
/// Both poses of a line are the sensor's in the map, from which maps are woven; the robot's would have to be got back
/// from it by way of the mount, and rounding would move cells. Numbers have as many digits as it takes to read the same
/// value again; ranges are metres with three decimals. No return is written as the sensor's range_max, no valid reading
/// as 0. The host name is the robot's name, both stamps are the scan's; but readers put lines into the order of their
/// stamps, so a scan that would go back further than they allow (robots with unlike clocks) has the latest stamp before
/// it, and a comment says so.
/// Source  CARMEN's logger format: ROBOTLASER1 of log_writer.c, with its remission count and turn_axis.
class CarmenText {
public:
    /// @param filter  which scans are integrated in the session's maps; no others become lines
    explicit CarmenText(ScanFilter filter = ScanFilter()) : filter_(std::move(filter)) {}

    /// The lines at the head of the file.
    [[nodiscard]] static std::string head(const std::string& session);

    /// The lines that an entry becomes; robots and sensors become none, but for a comment where a sensor reaches
    /// further than a reader may believe. Entries come in the order of the log.
    /// Errors  kConflict: what the format cannot say: an imported map, a scan of sonars, of beams that are not evenly
    ///         spaced, or of an aperture of its own. kMalformed: a scan of nothing known.
    [[nodiscard]] Result<std::string> lines(const LogEntry& entry);

private:
    [[nodiscard]] Result<std::string> text_of(const RobotJoined& joined);
    [[nodiscard]] Result<std::string> text_of(const SensorDescribed& described);
    [[nodiscard]] Result<std::string> text_of(const ScanTaken& taken);
    [[nodiscard]] static Result<std::string> text_of(const MapPatch& patch);
    [[nodiscard]] static Result<std::string> text_of(const ScansExcluded& excluded);
    [[nodiscard]] static Result<std::string> text_of(const ExclusionLifted& lifted);

    ScanFilter filter_;
    Revision revision_ = 0; ///< of the newest entry
    std::vector<std::string> robots_;
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_;
    double latest_ = std::numeric_limits<double>::lowest(); ///< stamp written
};

} // namespace scanloom::exchange
