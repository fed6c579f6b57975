#include "load/app/record_workload.hpp"

#include "common/wire/frame_decoder.hpp"
#include "load/core/measured_client.hpp"
#include "sim/drive/wall_follower.hpp"
#include "sim/robot/world_file.hpp"
#include "sim/simulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace scanloom::load {
namespace {

Result<sim::Simulator> make_simulator(const LoadOptions& options) {
    auto world = sim::load_world(options.world);
    if (!world) return world.error();
    auto laser = sim::find_laser(options.laser);
    if (!laser) return laser.error();
    sim::SimulatorOptions simulator;
    simulator.world = std::move(*world);
    simulator.laser = std::move(*laser);
    simulator.seed = options.seed;
    simulator.poses = options.poses;
    if (options.noise == "gaussian") {
        simulator.noise = sim::Noise{};
    } else if (options.poses == Poses::kOdometry) {
        simulator.noise = sim::Noise{.range = 0.0, .beam_angle = 0.0}; // that of the odometry, which always drifts
    }
    return sim::Simulator(std::move(simulator), std::make_unique<sim::WallFollower>());
}

Result<> check_batch(const Workload& workload) {
    std::vector<wire::NumberedScan> batch;
    for (std::uint64_t i = 0; i < workload.batch; ++i) {
        batch.push_back({&workload.scans.front(), MeasuredClient::kEndless, 1.0}); // the longest encoding of a number
    }
    const std::size_t size = wire::batch_frame_size(batch);
    if (size <= wire::kFrameBytesMax) return {};
    return Error{Errc::kTooLarge,
                 fmt::format("--batch {}: a frame of so many scans has {} bytes, at most {} are allowed; use fewer",
                             workload.batch, size, wire::kFrameBytesMax)};
}

} // namespace

Result<Workload> record_workload(const LoadOptions& options) {
    auto simulator = make_simulator(options);
    if (!simulator) return simulator.error();
    const bool is_paced = options.rate > 0.0;
    std::uint64_t count = options.course;
    if (is_paced) count = std::min(count, Schedule::scans_within(options.duration, options.rate));
    std::vector<Scan> scans;
    for (std::uint64_t i = 0; i < count; ++i) scans.push_back(simulator->next_scan());
    const double rate = is_paced ? options.rate : 1.0 / sim::kScanPeriod;
    Workload workload = make_workload(*simulator->sensors().front(), scans, rate, options.batch);
    if (is_paced) workload.schedule = Schedule(options.robots, options.rate);
    if (auto ok = check_batch(workload); !ok) return ok.error();
    return workload;
}

} // namespace scanloom::load
