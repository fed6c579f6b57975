#include "robot_client/ros/laser_conversion.hpp"
#include "robot_client/ros/messages.hpp"
#include "tests/fuzz/server_check.hpp"

#include <cmath>
#include <string>
#include <string_view>

namespace scanloom::robot {
namespace {

void check_scan(const RosLaserScan& message) {
    if (!check_usable(message)) return;
    constexpr RosTime kRecorded = 1'500'000'000;
    RangeHabits habits;
    habits.add(message);
    for (const auto& options : {RangeOptions{}, RangeOptions{8.0, {}, true, true}}) {
        const RangeMeaning meaning = habits.meaning(options);
        Sensor sensor = sensor_of(message, meaning, {});
        sensor.id = 1;
        sensor.name = "laser";
        fuzz::check_accepted(sensor);
        Scan scan = scan_of(message, kRecorded, meaning);
        scan.seq = 1;
        scan.sensor = 1;
        fuzz::check(scan.ranges.size() == beam_count(sensor.angles), "each beam has a reading");
        fuzz::check_accepted(wire::ScanBatch{{scan}});
    }
}

void check_transform(const RosTransform& transform) {
    const auto& matrix = transform.T_parent_child.matrix();
    fuzz::check(matrix.allFinite(), "transforms are finite");
    const Eigen::Matrix3d rotation = transform.T_parent_child.linear();
    fuzz::check((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6, "rotations are ones");
    const auto mount = mount_of(transform.T_parent_child);
    fuzz::check(mount || !mount.error().message.empty(), "every error has a message");
    fuzz::check(std::isfinite(planar(transform.T_parent_child).yaw), "poses in the plane are finite");
}

} // namespace
} // namespace scanloom::robot

/// Input: a byte that selects the encoding and the type, then a message.
SCANLOOM_FUZZER(ros_message)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    using namespace scanloom::robot;
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    const auto encoding = data[0] % 2 == 0 ? MessageEncoding::kRos1 : MessageEncoding::kCdr;
    const auto type = data[0] / 2 % 4;
    if (type < 2) {
        const auto scan = decode_laser_scan(bytes, encoding, type == 0 ? kLaserScanType : kMultiEchoType);
        if (scan) check_scan(*scan);
    } else if (type == 2) {
        if (const auto odometry = decode_odometry(bytes, encoding)) check_transform(*odometry);
    } else {
        std::size_t left_out = 0;
        const auto transforms = decode_transforms(bytes, encoding, left_out);
        if (!transforms) return 0;
        for (const auto& transform : *transforms) check_transform(transform);
    }
    return 0;
}
