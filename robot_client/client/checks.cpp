#include "robot_client/client/checks.hpp"

#include "common/link/printable_text.hpp"
#include "common/scan/limits.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"
#include "robot_client/sources/source.hpp"
#include "robot_client/uplink/limits.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace scanloom::robot {

namespace {

constexpr std::size_t kTokenBytesMax = 8192; ///< a hello has room for more

Error too_many(std::string_view what_has, std::size_t count, std::string_view of_what, std::size_t count_max) {
    return {Errc::kTooLarge, fmt::format("{} {} {}, at most {} are allowed", what_has, count, of_what, count_max)};
}

/// Decodes the message as the server does. Pre: it is no longer than a frame.
Result<> check_as_read(const wire::Message& message) {
    std::string frame;
    wire::encode(message, frame);
    const auto read = wire::decode(std::string_view(frame).substr(wire::kLengthPrefixBytes));
    if (!read) return read.error();
    return {};
}

/// Checks the sizes that have no limit in the caller's data but have one in a frame.
Result<> check_sizes(const Sensor& sensor, const Scan& scan) {
    if (sensor.name.size() > kNameBytesMax) {
        return too_many("the sensor's name has", sensor.name.size(), "bytes", kNameBytesMax);
    }
    if (!link::is_utf8(sensor.name)) {
        return Error{Errc::kInvalidField, fmt::format("the sensor's name '{}' is not UTF-8; give it a name in that",
                                                      link::printable(sensor.name))};
    }
    const std::size_t described = beam_count(sensor.angles);
    if (described > kBeamsMax) return too_many("the sensor's angles describe", described, "beams", kBeamsMax);
    if (scan.ranges.size() > kBeamsMax) return too_many("ranges has", scan.ranges.size(), "beams", kBeamsMax);
    if (scan.intensities.size() > kBeamsMax) {
        return too_many("intensities has", scan.intensities.size(), "values", kBeamsMax);
    }
    const std::size_t own = scan.angles ? beam_count(*scan.angles) : 0;
    if (own > kBeamsMax) return too_many("the scan's angles describe", own, "beams", kBeamsMax);
    return {};
}

Result<> check_within(std::string_view what, double value, std::string_view unit, double low, double high) {
    if (value >= low && value <= high) return {}; // false for NaN
    return Error{Errc::kInvalidField,
                 fmt::format("{} of {:g} {} cannot be; give {:g} to {:g}", what, value, unit, low, high)};
}

Result<> check_names(const ClientOptions& options) {
    for (const auto* name : {&options.session, &options.robot}) {
        if (is_valid_name(*name)) continue;
        return Error{Errc::kInvalidField,
                     fmt::format("'{}' is no name of a session or robot; use 1 to {} characters of A-Z a-z 0-9 _ -",
                                 link::printable(*name), kNameBytesMax)};
    }
    if (options.token.size() > kTokenBytesMax || !link::is_utf8(options.token)) {
        return Error{Errc::kInvalidField,
                     fmt::format("the token has {} bytes, or is not UTF-8; give the one that the server knows",
                                 options.token.size())};
    }
    return {};
}

} // namespace

Result<> check(const ClientOptions& options) {
    const auto mib = [](std::uint64_t bytes) { return static_cast<double>(bytes) / kMebibyte; };
    const double delay = std::chrono::duration<double>(options.batch_delay).count();
    const double cell_size = options.cell_size.value_or(kCellSizeMin);
    if (auto ok = check_names(options); !ok) return ok;
    if (options.body_radius && !is_body_radius(*options.body_radius)) {
        return Error{Errc::kInvalidField, fmt::format("a body_radius of {} m cannot be; give more than 0, at most {}",
                                                      *options.body_radius, kBodyRadiusMax)};
    }
    if (auto ok = check_within("a cell_size", cell_size, "m", kCellSizeMin, kCellSizeMax); !ok) return ok;
    if (auto ok = check_within("a batch_delay", delay, "s", 0.0, kBatchDelayMax); !ok) return ok;
    if (auto ok = check_within("memory_bytes_max", mib(options.memory_bytes_max), "MiB", kMemoryMibMin, kMemoryMibMax);
        !ok) {
        return ok;
    }
    return check_within("spool_bytes_max", mib(options.spool_bytes_max), "MiB", kSpoolMibMin, kSpoolMibMax);
}

Result<> check(const Sensor& sensor, const Scan& scan) {
    if (auto ok = check_sizes(sensor, scan); !ok) return ok;
    if (auto ok = check_as_read(sensor); !ok) return ok;
    wire::ScanBatch batch{{scan}};
    batch.scans.front().seq = 1;
    if (auto ok = check_as_read(batch); !ok) return ok;
    if (scan.sensor != sensor.id) {
        return Error{Errc::kInvalidField,
                     fmt::format("the scan is of sensor {}, the sensor given is {}", scan.sensor, sensor.id)};
    }
    return wire::check_scan(scan, sensor);
}

Result<> check_poses(const Scan& scan, Poses poses) {
    if (agrees_with(scan, poses)) return {};
    if (poses == Poses::kMap) {
        return Error{Errc::kInvalidField,
                     "the scan has no pose; set it to where the robot was in the map, or start the "
                     "client with other poses"};
    }
    if (scan.pose) {
        return Error{Errc::kInvalidField, fmt::format("the scan has a pose, but the client was started with poses {}; "
                                                      "leave the pose out",
                                                      name_of(poses))};
    }
    return Error{Errc::kInvalidField,
                 poses == Poses::kOdometry
                     ? "the scan has no odometry, but the client was started with poses odometry; set it"
                     : "the scan has an odometry, but the client was started with poses none; leave it out"};
}

Result<> check(const link::Request& request) {
    if (const auto* coverage = std::get_if<wire::CoverageRequest>(&request)) {
        const std::size_t corners = coverage->region.size();
        if (corners > wire::kRegionPointsMax) {
            return too_many("region has", corners, "corners", wire::kRegionPointsMax);
        }
    }
    return std::visit([](const auto& kind) { return check_as_read(kind); }, request);
}

} // namespace scanloom::robot
