#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "common/scan/poses.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "common/scan/session_options.hpp"

#include "scanloom/v1/scan.pb.h"
#include "scanloom/v1/session.pb.h"

#include <google/protobuf/repeated_field.h>

#include <cstdint>
#include <span>
#include <string_view>

/// Converts sensors, scans, poses, points and the settings of sessions between protobuf messages and plain values, for
/// frames and log entries. from_proto() validates every value of a scan or a sensor; the error names the field relative
/// to the message.
namespace scanloom::wire {

[[nodiscard]] Result<Sensor> from_proto(const v1::SensorDescription& description);
[[nodiscard]] Result<Scan> from_proto(const v1::Scan& scan);
/// Converts a scan whose ranges are given separately, in place of its own.
[[nodiscard]] Result<Scan> from_proto(const v1::Scan& scan, std::vector<RangeMm> ranges);
[[nodiscard]] Result<Pose2> from_proto(const v1::Pose2& pose);
[[nodiscard]] Result<Poses> from_proto(v1::Poses poses);

void to_proto(const Sensor& sensor, v1::SensorDescription& out);
void to_proto(const Scan& scan, v1::Scan& out);
void to_proto_without_ranges(const Scan& scan, v1::Scan& out);
void to_proto(const Pose2& pose, v1::Pose2& out);
[[nodiscard]] v1::Poses to_proto(Poses poses);

/// Points as differences: x and y of the first point, then x and y of each point minus those of the previous one.
/// Successive points are close to each other, so that a difference takes one or two bytes.
using Differences = google::protobuf::RepeatedField<std::int32_t>;

/// Appends the differences of the points. Precondition: the points are within kCoordinateMax.
void append_differences(std::span<const PointMm> points, Differences& out);

[[nodiscard]] Error invalid_field(std::string message);

/// Checks that a coordinate or an angle is finite and within kCoordinateMax.
/// Errors: kInvalidField; the message names the field.
[[nodiscard]] Result<> check_coordinate(std::string_view field, double value);

/// Does not check the ranges of the settings; the session does.
/// Errors: kInvalidField if an enumeration has a value that this program does not know.
[[nodiscard]] Result<SessionOptions> from_proto(const v1::SessionConfig& config);

void to_proto(const SessionOptions& options, v1::SessionConfig& out);

} // namespace scanloom::wire
