#include "robot_client/ros/messages.hpp"

#include "robot_client/ros/ros_reader.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace scanloom::robot {
namespace {

constexpr std::size_t kCovarianceSize = 36;

Error no_such_message(std::string_view type, std::size_t size) {
    return Error{Errc::kMalformed, fmt::format("{} bytes are no {}", size, type)};
}

/// Reads the name of a frame, without the leading "/" of early ROS 1.
std::string read_frame(RosReader& reader) {
    auto frame = reader.text();
    if (frame.starts_with('/')) frame.remove_prefix(1);
    return std::string(frame);
}

RosHeader read_header(RosReader& reader, MessageEncoding encoding) {
    constexpr RosTime kSecond = 1'000'000'000;
    if (encoding == MessageEncoding::kRos1) static_cast<void>(reader.number<std::uint32_t>()); // number of the message
    const RosTime seconds = encoding == MessageEncoding::kRos1 ? RosTime{reader.number<std::uint32_t>()}
                                                               : RosTime{reader.number<std::int32_t>()};
    const RosTime nanoseconds = reader.number<std::uint32_t>();
    return {seconds * kSecond + nanoseconds, read_frame(reader)};
}

std::vector<float> read_floats(RosReader& reader) {
    std::vector<float> floats(reader.count(sizeof(float)));
    for (auto& each : floats) each = reader.number<float>();
    return floats;
}

/// Reads the echoes of all beams. @return the first echo of each beam, in metres; infinity for a beam without one
std::vector<float> read_first_echoes(RosReader& reader) {
    std::vector<float> first(reader.count(sizeof(std::uint32_t)));
    for (auto& each : first) {
        const auto echoes = read_floats(reader);
        each = echoes.empty() ? std::numeric_limits<float>::infinity() : echoes.front();
    }
    return first;
}

Eigen::Vector3d read_vector(RosReader& reader) {
    const auto x = reader.number<double>();
    const auto y = reader.number<double>();
    const auto z = reader.number<double>();
    return {x, y, z};
}

/// Reads a translation and a rotation. @return nullopt if they are not finite, or the rotation is none
std::optional<Eigen::Isometry3d> read_transform(RosReader& reader) {
    const Eigen::Vector3d translation = read_vector(reader);
    const Eigen::Vector3d axis = read_vector(reader);
    const Eigen::Quaterniond rotation(reader.number<double>(), axis.x(), axis.y(), axis.z());
    constexpr double kNormMin = 1e-3;
    const double norm = rotation.norm();
    if (!translation.allFinite() || !std::isfinite(norm) || norm < kNormMin) return std::nullopt;
    return Eigen::Translation3d(translation) * rotation.normalized();
}

} // namespace

Result<RosLaserScan> decode_laser_scan(std::string_view bytes, MessageEncoding encoding, std::string_view type) {
    RosReader reader(bytes, encoding);
    RosLaserScan scan;
    scan.header = read_header(reader, encoding);
    for (float* field : {&scan.angle_min, &scan.angle_max, &scan.angle_increment, &scan.time_increment, &scan.scan_time,
                         &scan.range_min, &scan.range_max}) {
        *field = reader.number<float>();
    }
    const auto read = type == kMultiEchoType ? read_first_echoes : read_floats;
    scan.ranges = read(reader);
    static_cast<void>(read(reader)); // intensities
    if (!reader.is_complete()) return no_such_message(type, bytes.size());
    return scan;
}

Result<RosTransform> decode_odometry(std::string_view bytes, MessageEncoding encoding) {
    RosReader reader(bytes, encoding);
    RosTransform odometry;
    odometry.header = read_header(reader, encoding);
    odometry.child = read_frame(reader);
    const auto pose = read_transform(reader);
    constexpr std::size_t kTwistSize = 6;
    for (std::size_t n = 0; n < kCovarianceSize + kTwistSize + kCovarianceSize; ++n) {
        static_cast<void>(reader.number<double>());
    }
    if (!reader.is_complete()) return no_such_message(kOdometryType, bytes.size());
    if (!pose) return Error{Errc::kInvalidField, "the pose is not finite, or its orientation is zero"};
    odometry.T_parent_child = *pose;
    return odometry;
}

Result<std::vector<RosTransform>> decode_transforms(std::string_view bytes, MessageEncoding encoding,
                                                    std::size_t& left_out) {
    constexpr std::size_t kBytesMin = 7 * sizeof(double);
    RosReader reader(bytes, encoding);
    std::vector<RosTransform> transforms;
    std::size_t unusable = 0;
    for (auto count = reader.count(kBytesMin); count > 0 && !reader.failed(); --count) {
        RosTransform one;
        one.header = read_header(reader, encoding);
        one.child = read_frame(reader);
        const auto T_parent_child = read_transform(reader);
        const bool is_usable = T_parent_child && !one.child.empty() && one.child != one.header.frame;
        if (!is_usable) ++unusable;
        if (!is_usable) continue;
        one.T_parent_child = *T_parent_child;
        transforms.push_back(std::move(one));
    }
    if (!reader.is_complete()) return no_such_message(kTransformsType, bytes.size());
    left_out += unusable;
    return transforms;
}

} // namespace scanloom::robot
