#include "common/hash/crc32c.hpp"
#include "common/wire/compression.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/log_codec.hpp"
#include "common/wire/messages.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/checkpoint.hpp"
#include "server/store/rocksdb_store.hpp"
#include "tests/fuzz/corpus.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/stored_text.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fuzz {
namespace {

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

} // namespace

void write_corpus(const std::filesystem::path& folder) {
    write_messages(folder / "messages");
    write_streams(folder / "frame_decoder");
    write_log_entries(folder / "log_codec");
    write_log_files(folder / "log_file");
    write_checkpoint(folder / "checkpoint");
    write_estimated_checkpoint(folder / "checkpoint");
    write_earlier_checkpoints(folder / "checkpoint");
}

} // namespace scanloom::fuzz
