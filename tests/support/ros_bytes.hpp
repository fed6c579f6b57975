#pragma once

#include "robot_client/ros/messages.hpp"

#include <Eigen/Geometry>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

/// Writes ROS messages for tests, apart from the program's reader.
namespace scanloom::testing_support {

class RosWriter {
public:
    /// @param is_big_endian  only with CDR
    explicit RosWriter(robot::MessageEncoding encoding, bool is_big_endian = false)
        : is_cdr_(encoding == robot::MessageEncoding::kCdr), is_big_endian_(is_big_endian) {
        if (is_cdr_) bytes_ = std::string{'\0', is_big_endian ? '\0' : '\1', '\0', '\0'};
    }

    template <class T>
    RosWriter& add(T value) {
        while (is_cdr_ && (bytes_.size() - 4) % sizeof(T) != 0) bytes_ += '\xAA';
        std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
        if (is_big_endian_) raw.assign(raw.rbegin(), raw.rend());
        bytes_ += raw;
        return *this;
    }

    RosWriter& add_text(std::string_view text) {
        add(static_cast<std::uint32_t>(text.size() + (is_cdr_ ? 1 : 0)));
        bytes_ += text;
        if (is_cdr_) bytes_ += '\0';
        return *this;
    }

    RosWriter& add_floats(const std::vector<float>& floats) {
        add(static_cast<std::uint32_t>(floats.size()));
        for (const float each : floats) add(each);
        return *this;
    }

    RosWriter& add_header(std::int64_t stamp, std::string_view frame) {
        constexpr std::int64_t kSecond = 1'000'000'000;
        if (!is_cdr_) add(std::uint32_t{7}); // number of the message
        add(static_cast<std::uint32_t>(stamp / kSecond));
        add(static_cast<std::uint32_t>(stamp % kSecond));
        return add_text(frame);
    }

    RosWriter& add_pose(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation) {
        for (const double each : {translation.x(), translation.y(), translation.z()}) add(each);
        for (const double each : {rotation.x(), rotation.y(), rotation.z(), rotation.w()}) add(each);
        return *this;
    }

    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
    bool is_cdr_;
    bool is_big_endian_;
};

/// A rotation about the vertical axis.
inline Eigen::Quaterniond turned(double yaw) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
}

inline std::string laser_bytes(const robot::RosLaserScan& scan,
                               robot::MessageEncoding encoding = robot::MessageEncoding::kRos1) {
    RosWriter writer(encoding);
    writer.add_header(scan.header.stamp, scan.header.frame);
    for (const float each : {scan.angle_min, scan.angle_max, scan.angle_increment, scan.time_increment, scan.scan_time,
                             scan.range_min, scan.range_max}) {
        writer.add(each);
    }
    return writer.add_floats(scan.ranges).add_floats({}).bytes();
}

inline std::string odometry_bytes(const robot::RosTransform& odometry,
                                  robot::MessageEncoding encoding = robot::MessageEncoding::kRos1) {
    RosWriter writer(encoding);
    writer.add_header(odometry.header.stamp, odometry.header.frame).add_text(odometry.child);
    writer.add_pose(odometry.T_parent_child.translation(), Eigen::Quaterniond(odometry.T_parent_child.linear()));
    for (int n = 0; n < 36 + 6 + 36; ++n) writer.add(0.0);
    return writer.bytes();
}

inline std::string transform_bytes(const std::vector<robot::RosTransform>& transforms,
                                   robot::MessageEncoding encoding = robot::MessageEncoding::kRos1) {
    RosWriter writer(encoding);
    writer.add(static_cast<std::uint32_t>(transforms.size()));
    for (const auto& one : transforms) {
        writer.add_header(one.header.stamp, one.header.frame).add_text(one.child);
        writer.add_pose(one.T_parent_child.translation(), Eigen::Quaterniond(one.T_parent_child.linear()));
    }
    return writer.bytes();
}

/// A transform in the plane.
inline robot::RosTransform flat(std::int64_t stamp, const std::string& parent, const std::string& child, double x,
                                double y = 0.0, double yaw = 0.0) {
    return {{stamp, parent}, child, Eigen::Translation3d(x, y, 0.0) * turned(yaw)};
}

} // namespace scanloom::testing_support
