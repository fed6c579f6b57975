#include "common/wire/log_codec.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/recovery.hpp"
#include "server/store/rocksdb_store.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/room_scans.hpp"
#include "tests/support/temporary_directory.hpp"

#include <benchmark/benchmark.h>

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <span>
#include <string>
#include <vector>

// The cost of a scan as the number of cells, the sensor's beams and the map grow: all layers, with a snapshot after
// each scan as with a viewer that is always connected (and, by extent, also without a viewer); the memory of a map; and
// the time of its recovery, from memory and from a store on disk. Each argument at least doubles, so superlinear cost
// shows as a line that bends upwards.

namespace scanloom::bench {
namespace {

constexpr int kRoomScans = 60;

/// Returns a scan of the round through the room, moved to one of many adjacent rooms. Rooms are numbered outwards from
/// the origin in squares.
Scan in_room(const Scan& scan, int room, std::uint64_t seq) {
    const int side = static_cast<int>(std::sqrt(static_cast<double>(room)));
    const int along = room - side * side;
    Scan moved = scan;
    moved.seq = seq;
    moved.pose->x += 10.0 * (along <= side ? side : 2 * side - along);
    moved.pose->y += 10.0 * (along <= side ? along : side);
    return moved;
}

class Mapper {
public:
    Mapper(double cell_size_m, const Sensor& sensor) : projection_(config_of(cell_size_m)) {
        keep(RobotJoined{0, "robot"});
        keep(SensorDescribed{0, sensor});
    }

    void integrate(const Scan& scan, int room = 0) { keep(ScanTaken{0, in_room(scan, room, ++seq_)}); }
    [[nodiscard]] mapping::Snapshot snapshot() { return projection_.snapshot(); }

private:
    static mapping::MapConfig config_of(double cell_size_m) {
        mapping::MapConfig config;
        config.cell_size = cell_size_m;
        return config;
    }

    void keep(const LogEntry& entry) {
        if (!projection_.apply(entry)) std::abort();
    }

    mapping::Projection projection_;
    std::uint64_t seq_ = 0;
};

/// The worst case: a reader holds the newest maps at every scan.
void run(benchmark::State& state, Mapper& mapper, const std::vector<Scan>& scans) {
    for (const Scan& scan : scans) mapper.integrate(scan);
    mapping::Snapshot shown = mapper.snapshot();
    std::size_t next = 0;
    for (auto _ : state) {
        mapper.integrate(scans[next]);
        shown = mapper.snapshot();
        next = next + 1 == scans.size() ? 0 : next + 1;
    }
}

/// The argument: cell size in millimetres.
void ScanByCellSize(benchmark::State& state) {
    Mapper mapper(static_cast<double>(state.range(0)) * 0.001, testing_support::reference_laser());
    run(state, mapper, testing_support::room_scans(kRoomScans));
}

void ScanByBeams(benchmark::State& state) {
    Sensor laser = testing_support::reference_laser();
    const auto beams = static_cast<std::uint32_t>(state.range(0));
    laser.angles = UniformAngles{-std::numbers::pi / 2, std::numbers::pi / beams, beams};
    auto scans = testing_support::room_scans(kRoomScans);
    for (Scan& scan : scans) {
        scan.ranges.clear();
        for (std::size_t beam = 0; beam < beams; ++beam) {
            const double direction = scan.pose->yaw + beam_angle(laser.angles, beam);
            const double range = testing_support::room_range({scan.pose->x, scan.pose->y}, direction);
            scan.ranges.push_back(range < laser.range_max ? to_range_mm(range) : kNoReturn);
        }
    }
    Mapper mapper(0.05, laser);
    run(state, mapper, scans);
}

Mapper mapper_of_rooms(std::int64_t rooms, const std::vector<Scan>& scans) {
    Mapper mapper(0.05, testing_support::reference_laser());
    for (int room = 0; room < rooms; ++room) {
        for (std::size_t n = 0; n < scans.size(); n += 6) mapper.integrate(scans[n], room);
    }
    return mapper;
}

/// The argument: number of other rooms of 10 x 10 m in the map.
void ScanByExtent(benchmark::State& state) {
    const auto scans = testing_support::room_scans(kRoomScans);
    Mapper mapper = mapper_of_rooms(state.range(0), scans);
    run(state, mapper, scans);
}

/// ScanByExtent without a reader that holds the maps, as in a server without viewers.
void UnseenScanByExtent(benchmark::State& state) {
    const auto scans = testing_support::room_scans(kRoomScans);
    Mapper mapper = mapper_of_rooms(state.range(0), scans);
    for (const Scan& scan : scans) mapper.integrate(scan);
    std::size_t next = 0;
    for (auto _ : state) {
        mapper.integrate(scans[next]);
        next = next + 1 == scans.size() ? 0 : next + 1;
    }
}

/// Returns the bytes allocated by the allocator, its own overhead included.
double allocated_bytes() {
    const auto info = ::mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
}

std::size_t touched_cells(const mapping::Snapshot& map) {
    std::size_t touched = 0;
    map.laser.visit({}, 0, [&](grid::ChunkKey, const mapping::LaserChunk& chunk) {
        touched += static_cast<std::size_t>(
            std::ranges::count_if(chunk.himm, [](auto count) { return count != mapping::kUnseenHimm; }));
    });
    return touched;
}

/// The argument: number of rooms. Counters report the bytes of all parts of a map (layers, trees, trajectory, the
/// allocator's overhead), in total and per cell that any scan has changed.
void MemoryByArea(benchmark::State& state) {
    const auto scans = testing_support::room_scans(kRoomScans);
    mapper_of_rooms(1, scans); // so that objects shared by all maps exist before the measurement
    for (auto _ : state) {
        const double before = allocated_bytes();
        Mapper mapper(0.05, testing_support::reference_laser());
        for (int room = 0; room < state.range(0); ++room) {
            for (const Scan& scan : scans) mapper.integrate(scan, room);
        }
        const double bytes = allocated_bytes() - before;
        const auto touched = static_cast<double>(touched_cells(mapper.snapshot()));
        state.counters["bytes"] = bytes;
        state.counters["bytes_per_touched_cell"] = bytes / touched;
        state.counters["square_metres"] = touched * 0.0025;
    }
}

/// Returns the entries of a robot that drove around in one room.
std::vector<std::string> entries_of(std::int64_t count) {
    const auto scans = testing_support::room_scans(kRoomScans);
    std::vector<std::string> entries{wire::encode_entry(RobotJoined{0, "robot"}),
                                     wire::encode_entry(SensorDescribed{0, testing_support::reference_laser()})};
    for (std::int64_t n = 0; n < count; ++n) {
        const auto seq = static_cast<std::uint64_t>(n) + 1;
        entries.push_back(wire::encode_entry(ScanTaken{0, in_room(scans[seq % scans.size()], 0, seq)}));
    }
    return entries;
}

void recover_each_time(benchmark::State& state, store::ScanLog& log, store::SessionId session) {
    const std::atomic<bool> stop = false;
    for (auto _ : state) {
        auto recovered = sessions::recover(log, session, {}, stop);
        if (!recovered) return state.SkipWithError(recovered.error().message.c_str());
        benchmark::DoNotOptimize(recovered);
    }
    state.SetItemsProcessed(state.range(0) * state.iterations());
}

/// The argument: number of scans in the log, without a checkpoint. Items are scans.
void RecoveryByLogLength(benchmark::State& state) {
    store::MemoryScanLog log;
    const auto session = log.create_session({}).value();
    store::append_and_wait(log, session, 1, entries_of(state.range(0))).value();
    recover_each_time(state, log, session);
}

/// Recovery from a store in the system's temporary directory (TMPDIR selects another), reopened each time. Its files
/// may be in the system's page cache.
void RecoveryFromDisk(benchmark::State& state) {
    constexpr std::size_t kBatch = 512;
    TemporaryDirectory directory;
    auto log = store::open_rocksdb(directory.path()).value();
    const auto session = log->create_session({}).value();
    const auto entries = entries_of(state.range(0));
    for (std::size_t n = 0; n < entries.size(); n += kBatch) {
        const auto batch = std::span(entries).subspan(n, std::min(kBatch, entries.size() - n));
        store::append_and_wait(*log, session, n + 1, {batch.begin(), batch.end()}).value();
    }
    log.reset();
    log = store::open_rocksdb(directory.path()).value();
    recover_each_time(state, *log, session);
}

BENCHMARK(ScanByCellSize)->Arg(500)->Arg(200)->Arg(100)->Arg(50)->Arg(20)->Arg(10)->Unit(benchmark::kMicrosecond);
BENCHMARK(ScanByBeams)->RangeMultiplier(4)->Range(16, 4096)->Unit(benchmark::kMicrosecond);
BENCHMARK(ScanByExtent)->RangeMultiplier(4)->Range(1, 1024)->Unit(benchmark::kMicrosecond);
BENCHMARK(UnseenScanByExtent)->RangeMultiplier(4)->Range(1, 1024)->Unit(benchmark::kMicrosecond);
BENCHMARK(MemoryByArea)->RangeMultiplier(4)->Range(1, 256)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(RecoveryByLogLength)->RangeMultiplier(4)->Range(1024, 65536)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(RecoveryFromDisk)->RangeMultiplier(4)->Range(1024, 65536)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
} // namespace scanloom::bench
