#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include "scanloom/v1/scan.pb.h"

/// Converts sensors, scans and poses between protobuf messages and plain values, for frames and log entries.
/// from_proto() validates every value; the error names the field relative to the message.
namespace scanloom::wire {

[[nodiscard]] Result<Sensor> from_proto(const v1::SensorDescription& description);
[[nodiscard]] Result<Scan> from_proto(const v1::Scan& scan);
/// Converts a scan whose ranges are given separately, in place of its own.
[[nodiscard]] Result<Scan> from_proto(const v1::Scan& scan, std::vector<RangeMm> ranges);
[[nodiscard]] Result<Pose2> from_proto(const v1::Pose2& pose);

void to_proto(const Sensor& sensor, v1::SensorDescription& out);
void to_proto(const Scan& scan, v1::Scan& out);
void to_proto_without_ranges(const Scan& scan, v1::Scan& out);
void to_proto(const Pose2& pose, v1::Pose2& out);

[[nodiscard]] Error invalid_field(std::string message);

} // namespace scanloom::wire
