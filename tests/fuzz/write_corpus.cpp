#include "tests/fuzz/write_corpus.hpp"

#include "common/hash/crc32c.hpp"
#include "common/wire/compression.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/log_codec.hpp"
#include "common/wire/messages.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/checkpoint.hpp"
#include "server/store/rocksdb_store.hpp"
#include "tests/fuzz/lidar_seeds.hpp"
#include "tests/support/bag_writer.hpp"
#include "tests/support/ld06_bytes.hpp"
#include "tests/support/lidar_emulators.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/mcap_writer.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/ros_bytes.hpp"
#include "tests/support/stored_text.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace scanloom::fuzz {
namespace {

void write_file(const std::filesystem::path& path, std::string_view bytes) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

Sensor laser() {
    return {.id = 1,
            .kind = SensorKind::kLaser,
            .name = "front",
            .mount = {0.1, 0.0, 0.0},
            .angles = UniformAngles{-1.5, 0.75, 5},
            .aperture = 0.01,
            .range_min = 0.1,
            .range_max = 30.0};
}

Sensor sonar_ring() {
    return {.id = 2,
            .kind = SensorKind::kSonar,
            .name = "ring",
            .mount = {},
            .angles = ExplicitAngles{-1.57, -0.5, 0.0, 0.5, 1.57},
            .aperture = 0.5,
            .range_min = 0.2,
            .range_max = 5.0};
}

Scan plain_scan() {
    Scan scan;
    scan.seq = 1;
    scan.stamp = 1.5;
    scan.sensor = 1;
    scan.pose = {1.0, -2.0, 0.5};
    scan.ranges = {1000, 2500, kNoReturn, kInvalidRange, 29'999};
    return scan;
}

Scan full_scan() {
    Scan scan = plain_scan();
    scan.seq = 2;
    scan.odometry = Pose2{0.9, -2.1, 0.4};
    scan.intensities = {1, 20, 300, 4000, 50'000};
    scan.angles = ExplicitAngles{-0.2, -0.1, 0.0, 0.1, 0.2};
    return scan;
}

/// As an LD06 takes it.
Scan stepped_scan() {
    Scan scan = plain_scan();
    scan.seq = 3;
    scan.duration = -0.0995;
    scan.angles = SteppedAngles{1.5866e-5, {871, 1742, 2620, 11'000, 395'900}};
    return scan;
}

SessionOptions options() {
    return {.cell_size = 0.05, .ray_model = RayModel::kTraversal, .p_occupied = 0.9, .himm_increment = 3};
}

wire::CompressedScanBatch compressed() {
    std::string frame;
    wire::encode(wire::ScanBatch{std::vector<Scan>(10, plain_scan())}, frame);
    return wire::Compressor().compress(std::string_view(frame).substr(wire::kLengthPrefixBytes)).value();
}

std::vector<wire::Message> messages() {
    return {
        wire::Hello{wire::kProtocolVersion, "r1", "lab", "secret", options(), "scanloom-robot 0.1.0", "carmen:9f3a"},
        wire::Welcome{"5f1c", 17, {1 << 20, 4096, 1024}, 1 << 22},
        laser(),
        sonar_ring(),
        wire::ScanBatch{{plain_scan(), full_scan(), stepped_scan()}},
        wire::Ack{17, 16, 1 << 22},
        wire::LinkError{{Errc::kInvalidField, "scan_batch.scans[3].pose.x is nan"}, false},
        wire::Ping{42},
        wire::Pong{42},
        wire::Goodbye{"done"},
        wire::Correction{{1.0, 2.0, 3.0}, 9, 0.9, 0.002, 0.001, LocalizationState::kLost},
        wire::PlanRequest{1, Point2{1.0, 2.0}, {3.0, 4.0}, true, 0.2, 2.0},
        wire::PlanReply{1, 9, wire::Path{{{1.0, 2.0}, {3.0, 4.0}}, 2.9, 3.5}},
        wire::PlanReply{1, 9, Error{Errc::kNoPath, "the goal (3, 4) is inside an obstacle"}},
        wire::GoalRequest{2, Point2{1.0, 2.0}, 0.2, 5},
        wire::GoalReply{2, 9,
                        wire::Goal{wire::Exploration::kGoal, wire::Path{{{1.0, 2.0}}, 0.0, 0.0}, Point2{1.0, 2.5}}},
        wire::GoalReply{2, 9, wire::Goal{wire::Exploration::kComplete, std::nullopt, std::nullopt}},
        wire::CoverageRequest{3, Point2{1.0, 2.0}, 0.2, 0.4, {{0.0, 0.0}, {4.0, 0.0}, {0.0, 4.0}}},
        wire::CoverageReply{3, 9, wire::Coverage{wire::Path{{{1.0, 2.0}, {3.0, 4.0}}, 2.9, 3.5}, 8.0, 7.5}},
        compressed(),
        wire::LocateRequest{4, std::vector<PointMm>(20, PointMm{1200, -350}), {0.1, 0.2}, wire::Near{{3.0, 4.0}, 5.0}},
        wire::LocateReply{4, 9, wire::Correction{{1.0, 2.0, 3.0}, 9, 0.9, 0.002, 0.001}},
        wire::LocateReply{4, 9, Error{Errc::kAmbiguous, "another pose, 3.10 m and 180 degrees away, explains 91 %"}},
    };
}

void write_messages(const std::filesystem::path& folder) {
    int count = 0;
    for (const auto& message : messages()) {
        std::string frame;
        wire::encode(message, frame);
        write_file(folder / fmt::format("{:02}-{}", ++count, wire::name_of(message)),
                   std::string_view(frame).substr(wire::kLengthPrefixBytes));
    }
}

void write_streams(const std::filesystem::path& folder) {
    std::string stream;
    for (const auto& message : messages()) wire::encode(message, stream);
    write_file(folder / "whole", std::string(1, '\0') + stream);
    write_file(folder / "split", "\x05\x01\x02\x03\x0d\x61" + stream);
    write_file(folder / "truncated", std::string(1, '\0') + stream.substr(0, stream.size() - 3));
    write_file(folder / "too_large", std::string("\0\x7f\xff\xff\xff", 5));
}

void write_log_entries(const std::filesystem::path& folder) {
    write_file(folder / "robot_joined", wire::encode_entry(RobotJoined{0, "r1"}));
    write_file(folder / "laser_described", wire::encode_entry(SensorDescribed{0, laser()}));
    write_file(folder / "sonar_described", wire::encode_entry(SensorDescribed{0, sonar_ring()}));
    write_file(folder / "scan_taken", wire::encode_entry(ScanTaken{0, full_scan()}));
    write_file(folder / "stepped_scan_taken", wire::encode_entry(ScanTaken{0, stepped_scan()}));
    write_file(folder / "map_patch",
               wire::encode_entry(MapPatch{0.05, -1.0, 2.0, 2, {MapCell::kFree, MapCell::kOccupied}}));
    write_file(folder / "session", wire::encode_session({"lab", 1.7e9, options()}));
}

/// One record of RocksDB's log file format (server/store/log_file.hpp).
std::string log_record(unsigned char type, std::string_view payload) {
    const auto checksum = crc32c(std::string_view(reinterpret_cast<const char*>(&type), 1), payload);
    unsigned char header[7];
    boost::endian::store_little_u32(header, std::rotr(checksum, 15) + 0xa282ead8U);
    boost::endian::store_little_u16(header + 4, static_cast<std::uint16_t>(payload.size()));
    header[6] = type;
    return std::string(reinterpret_cast<const char*>(header), sizeof header).append(payload);
}

void write_log_files(const std::filesystem::path& folder) {
    const std::string file = log_record(1, "one write") + log_record(2, "two ") + log_record(4, "pieces");
    write_file(folder / "whole", file);
    write_file(folder / "torn", std::string_view(file).substr(0, file.size() - 4));
    write_file(folder / "damaged", "!" + file.substr(1));
}

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

void append_text(std::string& out, std::string_view text) {
    unsigned char length[2];
    boost::endian::store_little_u16(length, static_cast<std::uint16_t>(text.size()));
    out.append(reinterpret_cast<const char*>(length), sizeof length).append(text);
}

void write_parts(const std::filesystem::path& path, store::ScanLog& log, store::SessionId id) {
    std::string parts;
    for (const auto& [key, value] : store::checkpoint_of(log, id).value()) {
        append_text(parts, key);
        append_text(parts, value);
    }
    write_file(path, parts);
}

void write_checkpoint(const std::filesystem::path& folder) {
    mapping::Projection projection{mapping::MapConfig{}};
    // One beam, into one chunk of the map.
    Scan scan;
    scan.seq = 1;
    scan.sensor = 1;
    scan.pose = {0.5, 0.5, 0.0};
    scan.ranges = {700};
    for (const LogEntry& entry :
         {LogEntry{RobotJoined{0, "r1"}}, LogEntry{SensorDescribed{0, laser()}}, LogEntry{ScanTaken{0, scan}}}) {
        if (const auto applied = projection.apply(entry); !applied) throw std::runtime_error(applied.error().message);
    }
    store::MemoryScanLog log;
    const auto id = log.create_session("s").value();
    sessions::write_checkpoint(log, id, projection.snapshot(), projection.state(), 0, false).value();
    write_parts(folder / "one_scan", log, id);
}

/// A robot whose pose the server estimates.
void write_estimated_checkpoint(const std::filesystem::path& folder) {
    localization::LocalizedProjection maps(mapping::Projection{mapping::MapConfig{}});
    Scan scan;
    scan.seq = 1;
    scan.sensor = 1;
    scan.odometry = {0.5, 0.5, 0.0};
    scan.ranges = {700};
    for (LogEntry entry : {LogEntry{RobotJoined{0, "r1", {}, {}, Poses::kOdometry}},
                           LogEntry{SensorDescribed{0, laser()}}, LogEntry{ScanTaken{0, scan}}}) {
        double work = HUGE_VAL;
        if (const auto applied = maps.apply(entry, work); !applied) throw std::runtime_error(applied.error().message);
    }
    store::MemoryScanLog log;
    const auto id = log.create_session("s").value();
    sessions::write_checkpoint(log, id, maps.projection().snapshot(), maps.projection().state(), 0, false,
                               sessions::estimation_to_store(maps))
        .value();
    write_parts(folder / "estimated_pose", log, id);
}

/// As earlier versions wrote them, with parts that there are no more.
void write_earlier_checkpoints(const std::filesystem::path& folder) {
    for (const char* version : {"parts_2", "parts_3"}) {
        const TemporaryDirectory place;
        const auto text = fmt::format(SCANLOOM_SOURCE_DIR "/tests/data/store_2_{}.txt", version);
        store::write_store(text, place.path() / "store");
        write_parts(folder / version, *store::open_rocksdb(place.path() / "store").value(), 1);
    }
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
    write_messages(folder / "messages");
    write_streams(folder / "frame_decoder");
    write_log_entries(folder / "log_codec");
    write_log_files(folder / "log_file");
    write_ld06_streams(folder / "ld06");
    write_lidar_streams(folder);
    write_checkpoint(folder / "checkpoint");
    write_estimated_checkpoint(folder / "checkpoint");
    write_earlier_checkpoints(folder / "checkpoint");
    write_recordings(folder);
    write_ros_messages(folder / "ros_message");
    write_frame_trees(folder / "frame_tree");
    write_bridges(folder / "foxglove");
}

} // namespace scanloom::fuzz
