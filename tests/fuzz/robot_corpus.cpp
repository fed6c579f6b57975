#include "tests/fuzz/corpus.hpp"
#include "tests/fuzz/lidar_seeds.hpp"
#include "tests/support/bag_writer.hpp"
#include "tests/support/ld06_bytes.hpp"
#include "tests/support/lidar_emulators.hpp"
#include "tests/support/mcap_writer.hpp"
#include "tests/support/ros_bytes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fuzz {
namespace {

/// What an LD06 sends: turns, whole, split, and with what a bad line does to them.
void write_ld06_streams(const std::filesystem::path& folder) {
    using namespace testing_support;
    const auto write = [&](const char* name, std::string_view head, const Bytes& bytes) {
        write_file(folder / name, std::string(head).append(bytes.begin(), bytes.end()));
    };
    Ld06Spinner sensor(35'000, 29'950);
    const Bytes turn = sensor.next_bytes(44);
    write("a_turn", {"\0", 1}, turn);
    write("a_turn_smoothed_and_split", "\x85\x01\x2e\x2f\x30\x07", turn);
    Bytes damaged = turn;
    for (std::size_t at = 30; at < damaged.size(); at += 400) damaged[at] ^= 0x20;
    damaged.insert(damaged.begin() + 5 * 47, {0x54, 0x54, 0x2C});
    damaged.erase(damaged.begin() + 900, damaged.begin() + 1100);
    write("a_damaged_turn", {"\0", 1}, damaged);
    Bytes jumps = Ld06Spinner(35'900, 5'000).next_bytes(3);
    append(jumps, Ld06Spinner(10'000, 2'000).next_bytes(2));
    append(jumps, Ld06Spinner(35'500, 9'000).next_bytes(3));
    write("jumps", {"\0", 1}, jumps);
}

/// What other lidars answer and send.
void write_lidar_streams(const std::filesystem::path& folder) {
    using namespace testing_support;
    constexpr char kSecondModel = 16; // see check_lidar()
    const auto write = [&](const char* fuzzer, std::string_view prefix, LidarEmulator& emulator,
                           const std::vector<std::string>& requests, char model) {
        for (const auto& [name, input] : fuzz::lidar_seeds(emulator, requests, model)) {
            write_file(folder / fuzzer / std::string(prefix).append(name), input);
        }
    };
    HokuyoEmulator hokuyo;
    write("hokuyo", "", hokuyo, {"QT\nSCIP2.0\nVV\nPP\nMD0000108001000\n"}, 0);
    const std::string start("\xA5\x50\xA5\x52\xA5\x82\x05\0\0\0\0\0\x22\xA5\x20", 15);
    RplidarEmulator capsules({.firmware_minor = 29});
    write("rplidar", "capsules_", capsules, {start.substr(0, 13)}, 0);
    RplidarEmulator nodes;
    write("rplidar", "nodes_", nodes, {start}, kSecondModel);
    YdlidarEmulator x4(false);
    write("ydlidar", "x4_", x4, {"\xA5\x90\xA5\x92\xA5\x60"}, 0);
    YdlidarEmulator x2(true);
    write("ydlidar", "x2_", x2, {}, kSecondModel);
}

/// Recordings in each compression, and with what readers must tolerate.
void write_recordings(const std::filesystem::path& folder) {
    using namespace testing_support;
    const auto write = [&](const char* name, const WrittenRecording& recording) {
        write_file(folder / name, recording.file);
    };
    write("rosbag/none", small_bag({.chunk_bytes = 200}, 6));
    write("rosbag/bz2", small_bag({.compression = "bz2", .chunk_bytes = 200}, 6));
    write("rosbag/lz4", small_bag({.compression = "lz4", .chunk_bytes = 200}, 6));
    write("rosbag/not_closed", small_bag({.compression = "lz4", .is_closed = false, .has_sizes = false}, 6));
    write("rosbag/of_2010", small_bag({.chunk_bytes = 200, .index_entry_bytes = 20}, 6));
    write("mcap/none", small_mcap({.chunk_bytes = 200}, 6));
    write("mcap/without_checksums", small_mcap({.chunk_bytes = 200, .has_checksums = false}, 6));
    write("mcap/lz4", small_mcap({.compression = "lz4", .chunk_bytes = 200}, 6));
    write("mcap/zstd", small_mcap({.compression = "zstd", .chunk_bytes = 200}, 6));
    write("mcap/not_closed", small_mcap({.chunk_bytes = 0, .is_closed = false}, 6));
}

/// Messages of ROS after the byte that selects encoding and type.
void write_ros_messages(const std::filesystem::path& folder) {
    using namespace testing_support;
    const robot::RosLaserScan scan{{1'500'000'000, "laser"},           -1.0F, 1.0F, 0.5F, 0.01F, 0.1F, 0.1F, 10.0F,
                                   {1.0F, 0.0F, INFINITY, 12.0F, 3.0F}};
    const std::vector<robot::RosTransform> transforms{flat(0, "odom", "base", 1.0), flat(9, "base", "laser", 0.2)};
    for (const auto encoding : {robot::MessageEncoding::kRos1, robot::MessageEncoding::kCdr}) {
        const bool is_cdr = encoding == robot::MessageEncoding::kCdr;
        const auto write = [&](const std::string& name, char type, const std::string& bytes) {
            const char selection = static_cast<char>(2 * type + (is_cdr ? 1 : 0));
            write_file(folder / (name + (is_cdr ? "_cdr" : "_ros1")), selection + bytes);
        };
        write("laser", 0, laser_bytes(scan, encoding));
        write("one_beam", 0, laser_bytes({{0, ""}, 0.0F, 0.0F, 0.0F, 0.0F, 0.1F, 0.1F, 10.0F, {1.0F}}, encoding));
        write("multi_echo", 1, laser_bytes(scan, encoding));
        write("odometry", 2, odometry_bytes(transforms[0], encoding));
        write("transforms", 3, transform_bytes(transforms, encoding));
    }
}

/// Whether there are loops, then transforms of four bytes: parent and child, stamp, translation, rotation.
void write_frame_trees(const std::filesystem::path& folder) {
    const auto transform = [](std::size_t parent, std::size_t child, char stamp) {
        return std::string{static_cast<char>(parent + 6 * child), stamp, '\x0a', '\x14'};
    };
    write_file(folder / "chain",
               std::string(1, 0) + transform(0, 1, 0) + transform(0, 1, 20) + transform(1, 2, 4) + transform(1, 2, 16));
    write_file(folder / "another_parent",
               std::string(1, 0) + transform(0, 1, 0) + transform(2, 1, 12) + transform(0, 1, 24));
    write_file(folder / "loop", "\1" + transform(0, 1, 12) + transform(1, 2, 12) + transform(2, 0, 12));
}

/// A frame of a bridge after its kind and its length.
std::string bridge_frame(char kind, const std::string& frame) {
    std::string bytes(1, kind);
    testing_support::append_little(bytes, static_cast<std::uint16_t>(frame.size()));
    return bytes + frame;
}

/// Frames of a bridge: a robot with a laser, transforms and odometry in each encoding.
void write_bridges(const std::filesystem::path& folder) {
    using namespace testing_support;
    const robot::RosLaserScan scan{{1'500'000'000, "laser"},           -1.0F, 1.0F, 0.5F, 0.01F, 0.1F, 0.1F, 10.0F,
                                   {1.0F, 0.0F, INFINITY, 12.0F, 3.0F}};
    for (const auto encoding : {robot::MessageEncoding::kRos1, robot::MessageEncoding::kCdr}) {
        const std::string name = encoding == robot::MessageEncoding::kCdr ? "cdr" : "ros1";
        const auto message = [](char subscription, const std::string& payload) {
            return bridge_frame(1, std::string("\1") + subscription + std::string(11, '\0') + payload);
        };
        const auto channel = [&](int id, const std::string& topic, const std::string& type) {
            return fmt::format(R"({{"id":{},"topic":"{}","encoding":"{}","schemaName":"{}"}})", id, topic, name, type);
        };
        const std::string advertise =
            fmt::format(R"({{"op":"advertise","channels":[{},{},{},{}]}})",
                        channel(1, "/scan", "sensor_msgs/LaserScan"), channel(2, "/tf", "tf2_msgs/TFMessage"),
                        channel(3, "/tf_static", "tf2_msgs/msg/TFMessage"), channel(4, "/odom", "nav_msgs/Odometry"));
        const auto transforms = [&](const std::vector<robot::RosTransform>& all) {
            return transform_bytes(all, encoding);
        };
        write_file(folder / name, bridge_frame(0, R"({"op":"serverInfo","name":"b","capabilities":["clientPublish"],)"
                                                  R"("supportedEncodings":[")" +
                                                      name + R"("]})") +
                                      bridge_frame(2, advertise) +
                                      message(3, transforms({flat(0, "base", "laser", 0.2)})) +
                                      message(2, transforms({flat(1'000'000'000, "odom", "base", 1.0)})) +
                                      message(4, odometry_bytes(flat(1'000'000'000, "odom", "base", 1.0), encoding)) +
                                      message(1, laser_bytes(scan, encoding)) +
                                      bridge_frame(6, R"({"op":"status","level":1,"message":"m"})") +
                                      message(2, transforms({flat(2'000'000'000, "odom", "base", 2.0)})) +
                                      bridge_frame(2, R"({"op":"unadvertise","channelIds":[1]})"));
    }
}

} // namespace

void write_corpus(const std::filesystem::path& folder) {
    write_ld06_streams(folder / "ld06");
    write_lidar_streams(folder);
    write_recordings(folder);
    write_ros_messages(folder / "ros_message");
    write_frame_trees(folder / "frame_tree");
    write_bridges(folder / "foxglove");
}

} // namespace scanloom::fuzz
