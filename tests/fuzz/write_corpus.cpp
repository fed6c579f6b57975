// Writes the seeds of the wire's fuzzers: one small valid input for each kind of message and record.
#include "common/wire/frame_decoder.hpp"
#include "common/wire/log_codec.hpp"
#include "common/wire/messages.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace {

using namespace scanloom;

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

SessionOptions options() { return {0.05, 0.9, 0.1, 0.5, 0.001, 0.999, 0.1, 0.0175}; }

std::vector<wire::Message> messages() {
    return {
        wire::Hello{wire::kProtocolVersion, "r1", "lab", "secret", options(), "scanloom-robot 0.1.0"},
        wire::Welcome{"5f1c", 17, {1 << 20, 4096, 1024}, 1 << 22},
        laser(),
        sonar_ring(),
        wire::ScanBatch{{plain_scan(), full_scan()}},
        wire::Ack{17, 16, 1 << 22},
        wire::LinkError{{Errc::kInvalidField, "scan_batch.scans[3].pose.x is nan"}, false},
        wire::Ping{42},
        wire::Pong{42},
        wire::Goodbye{"done"},
        wire::Correction{{1.0, 2.0, 3.0}, 9},
    };
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s CORPUS_FOLDER\n", argv[0]);
        return 2;
    }
    const std::filesystem::path folder = argv[1];

    std::string stream;
    int count = 0;
    for (const auto& message : messages()) {
        std::string frame;
        wire::encode(message, frame);
        stream += frame;
        write_file(folder / "messages" / (std::to_string(++count) + "-" + std::string(wire::name_of(message))),
                   std::string_view(frame).substr(wire::kLengthPrefixBytes));
    }

    write_file(folder / "frame_decoder" / "whole", std::string(1, '\0') + stream);
    write_file(folder / "frame_decoder" / "split", "\x05\x01\x02\x03\x0d\x61" + stream);
    write_file(folder / "frame_decoder" / "truncated", std::string(1, '\0') + stream.substr(0, stream.size() - 3));
    write_file(folder / "frame_decoder" / "too_large", std::string("\0\x7f\xff\xff\xff", 5));

    write_file(folder / "log_codec" / "robot_joined", wire::encode_entry(RobotJoined{0, "r1"}));
    write_file(folder / "log_codec" / "laser_described", wire::encode_entry(SensorDescribed{0, laser()}));
    write_file(folder / "log_codec" / "sonar_described", wire::encode_entry(SensorDescribed{0, sonar_ring()}));
    write_file(folder / "log_codec" / "scan_taken", wire::encode_entry(ScanTaken{0, full_scan()}));
    write_file(folder / "log_codec" / "session", wire::encode_session({"lab", 1.7e9, options()}));
    return 0;
}
