#include "robot_client/recordings/recording.hpp"
#include "tests/support/bag_writer.hpp"
#include "tests/support/mcap_writer.hpp"
#include "tests/support/temporary_directory.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include <sqlite3.h>

// Reading recordings of ROS in each format: the bytes of messages per second, from files in the page cache.

namespace scanloom::robot {
namespace {

constexpr int kScans = 20'000;

/// Returns the message of a scan of 360 beams in a room: floats, as a lidar measures them.
std::string scan_message(int number) {
    std::string bytes("\0\1\0\0", 4);
    for (int beam = 0; beam < 360; ++beam) {
        const double angle = 0.01745 * beam;
        const double noise = 0.01 * std::sin(beam * 12.9898 + number * 78.233);
        const auto range =
            static_cast<float>(2.0 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle))) + noise);
        char value[sizeof range];
        std::memcpy(value, &range, sizeof range);
        bytes.append(value, sizeof value);
    }
    return bytes;
}

void write_rosbag2(const std::filesystem::path& path) {
    sqlite3* database = nullptr;
    sqlite3_open(path.c_str(), &database);
    sqlite3_exec(database,
                 "BEGIN; CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
                 "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
                 "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
                 "INSERT INTO topics VALUES(1, '/scan', 'sensor_msgs/msg/LaserScan', 'cdr');",
                 nullptr, nullptr, nullptr);
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?1, ?2)", -1, &insert,
                       nullptr);
    for (int i = 0; i < kScans; ++i) {
        const std::string message = scan_message(i);
        sqlite3_bind_int64(insert, 1, i);
        sqlite3_bind_blob(insert, 2, message.data(), static_cast<int>(message.size()), SQLITE_TRANSIENT);
        sqlite3_step(insert);
        sqlite3_reset(insert);
    }
    sqlite3_finalize(insert);
    sqlite3_exec(database, "COMMIT", nullptr, nullptr, nullptr);
    sqlite3_close(database);
}

/// @param format  "bag", "mcap" or "db3"
void write_recording(const std::filesystem::path& path, std::string_view format, const std::string& compression) {
    using namespace testing_support;
    if (format == "db3") return write_rosbag2(path);
    const auto write = [&](auto writer) {
        const auto scans = writer.connect("/scan", "sensor_msgs/LaserScan");
        for (int i = 0; i < kScans; ++i) writer.write(scans, i, scan_message(i));
        std::ofstream(path, std::ios::binary) << writer.finish().file;
    };
    // The sizes of chunks that ROS's own recorders use.
    if (format == "bag") return write(BagWriter({.compression = compression, .chunk_bytes = std::size_t{768} << 10U}));
    write(McapWriter({.compression = compression, .chunk_bytes = std::size_t{4} << 20U}));
}

void read_recording(benchmark::State& state, const char* format, const char* compression) {
    const TemporaryDirectory directory;
    const auto path = directory.path() / "recording";
    write_recording(path, format, compression);
    std::int64_t bytes = 0;
    for (auto _ : state) {
        auto recording = open_recording(path);
        while (const auto message = *(*recording)->next()) bytes += static_cast<std::int64_t>(message->bytes.size());
    }
    state.SetBytesProcessed(bytes);
}

BENCHMARK_CAPTURE(read_recording, bag_none, "bag", "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_recording, bag_bz2, "bag", "bz2")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_recording, bag_lz4, "bag", "lz4")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_recording, mcap_none, "mcap", "")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_recording, mcap_lz4, "mcap", "lz4")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_recording, mcap_zstd, "mcap", "zstd")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_recording, db3, "db3", "")->Unit(benchmark::kMillisecond);

} // namespace
} // namespace scanloom::robot
