#include "core/localization/localized_projection.hpp"
#include "tests/bench/localization/drives.hpp"
#include "tests/bench/localization/stage_sampler.hpp"
#include "tests/bench/projection/peers.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <malloc.h>
#include <time.h>
#include <unistd.h>

// The cost of maps with estimated poses, in one thread: each run is a process of its own, so that memory can be
// compared; localization_bench.mjs alternates runs with different poses. Times are CPU times of the thread, which other
// programs on the machine change less than wall times.

namespace scanloom::bench {
namespace {

namespace json = boost::json;

constexpr std::size_t kSimulatedScans = 6000; // ten minutes
constexpr std::size_t kDriveBefore = 900;     // scans before a robot stands

double cpu_seconds() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

double resident_bytes() {
    std::ifstream file("/proc/self/statm"); // unit: pages; all, then resident ones
    double all = 0.0;
    double resident = 0.0;
    file >> all >> resident;
    return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

double allocated_bytes() {
    const auto info = ::mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
}

[[noreturn]] void fail(const std::string& message) {
    std::fprintf(stderr, "localization_bench: %s\n", message.c_str());
    std::exit(1);
}

/// The maps of one robot's drive, and what they cost.
class MeasuredMaps {
public:
    MeasuredMaps(const LaserDrive& drive, Poses poses)
        : drive_(drive), maps_(mapping::Projection(mapping::MapConfig())) {
        begin_ = {RobotJoined{0, "robot", {}, {}, poses}, SensorDescribed{0, drive.laser}};
        for (LogEntry entry : begin_) apply(entry);
    }

    /// Applies the next scan, and measures the time of it.
    void add_next() {
        LogEntry entry = ScanTaken{0, drive_.scans[added_++]};
        const double begun = cpu_seconds();
        apply(entry);
        microseconds_.push_back((cpu_seconds() - begun) * 1e6);
    }

    /// Makes the maps again if they are outdated, and measures the time of it. The server does so in the background,
    /// and less often: not before it has finished the last time.
    void correct() {
        if (!maps_.is_outdated()) return;
        const double begun = cpu_seconds();
        const Revision as_of = maps_.poses().corrected();
        maps_.replace(maps_of(shown_poses()), as_of);
        correction_seconds_ += cpu_seconds() - begun;
        ++corrections_;
    }

    [[nodiscard]] mapping::Projection maps_of(const std::vector<std::optional<Pose2>>& poses) const {
        mapping::Projection maps{mapping::MapConfig()};
        for (const LogEntry& entry : begin_) {
            if (auto applied = maps.apply(entry); !applied) fail(applied.error().message);
        }
        for (std::size_t n = 0; n < poses.size(); ++n) {
            ScanTaken taken{0, drive_.scans[n]};
            taken.scan.pose = poses[n];
            if (auto applied = maps.apply(taken); !applied) fail(applied.error().message);
        }
        return maps;
    }

    /// Returns the poses at which the maps show the scans.
    [[nodiscard]] std::vector<std::optional<Pose2>> shown_poses() const {
        std::vector<std::optional<Pose2>> poses;
        const auto estimated = maps_.poses().in_maps();
        for (std::size_t n = 0; n < added_; ++n) {
            const Scan& scan = drive_.scans[n];
            poses.push_back(scan.pose ? scan.pose : estimated.find(0, scan.seq));
        }
        return poses;
    }

    [[nodiscard]] const std::vector<double>& microseconds() const noexcept { return microseconds_; }
    [[nodiscard]] const localization::SessionPoses& poses() const noexcept { return maps_.poses(); }
    [[nodiscard]] std::size_t corrections() const noexcept { return corrections_; }
    [[nodiscard]] double correction_seconds() const noexcept { return correction_seconds_; }

private:
    void apply(LogEntry& entry) {
        double work = HUGE_VAL;
        const auto applied = maps_.apply(entry, work);
        if (!applied) fail(applied.error().message);
    }

    const LaserDrive& drive_;
    std::vector<LogEntry> begin_;
    localization::LocalizedProjection maps_;
    std::vector<double> microseconds_;
    std::size_t added_ = 0;
    std::size_t corrections_ = 0;
    double correction_seconds_ = 0.0;
};

json::object graph_json(const localization::SessionPoses& poses) {
    const auto graph = poses.graph();
    const auto* robot = poses.find(0);
    json::object figures{{"keyframes", graph.keyframes.size()}, {"edges", graph.edges.size()}};
    if (robot == nullptr) return figures;
    const auto& loops = robot->estimator().map().loop_figures();
    figures["loops"] = robot->estimator().loop_count();
    figures["matches"] = loops.matches;
    figures["stretch_tests"] = loops.stretch_tests;
    figures["optimizations"] = robot->estimator().map().optimization_count();
    return figures;
}

/// Returns the time of a Bresenham mapper for one of these scans at these poses, when it has integrated all once.
double bresenham_microseconds(const LaserDrive& drive, const std::vector<std::optional<Pose2>>& poses) {
    Column column{"", 0.05, drive.laser, {}, 0.0};
    double farthest = 0.0;
    for (std::size_t n = 0; n < poses.size(); ++n) {
        if (!poses[n]) continue;
        Scan& scan = column.scans.emplace_back(drive.scans[n]);
        scan.pose = compose(*poses[n], drive.laser.mount);
        farthest = std::max({farthest, std::fabs(scan.pose->x), std::fabs(scan.pose->y)});
    }
    column.half_side = farthest + drive.laser.range_max + 1.0;
    const auto mapper = std::ranges::find(peers(), "bresenham", &Peer::name)->make(column);
    for (const Scan& scan : column.scans) mapper->insert(scan);
    const double begun = cpu_seconds();
    for (const Scan& scan : column.scans) mapper->insert(scan);
    return (cpu_seconds() - begun) * 1e6 / static_cast<double>(std::max<std::size_t>(column.scans.size(), 1));
}

json::object measure(const LaserDrive& drive, Poses poses) {
    (void)bresenham_microseconds({drive.laser, {drive.scans.front()}}, {Pose2{}}); // so that shared memory exists
    const double resident_before = resident_bytes();
    const double allocated_before = allocated_bytes();
    MeasuredMaps maps(drive, poses);
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        maps.add_next();
        maps.correct();
    }
    const double resident = resident_bytes() - resident_before;
    const double allocated = allocated_bytes() - allocated_before;
    const auto shown = maps.shown_poses();
    const double before_same_maps = allocated_bytes();
    const auto same_maps = maps.maps_of(shown);
    const double allocated_by_maps = allocated_bytes() - before_same_maps;
    json::array microseconds;
    for (const double each : maps.microseconds()) microseconds.push_back(std::round(each * 10.0) / 10.0);
    return {{"scans", drive.scans.size()},
            {"beams", drive.scans.front().ranges.size()},
            {"microseconds", std::move(microseconds)},
            {"graph", graph_json(maps.poses())},
            {"corrections", maps.corrections()},
            {"correction_seconds", maps.correction_seconds()},
            {"resident_bytes", resident},
            {"allocated_bytes", allocated},
            {"allocated_bytes_of_maps", allocated_by_maps},
            {"chunks", same_maps.chunk_count()},
            {"bresenham_microseconds", bresenham_microseconds(drive, shown)}};
}

/// Returns the share of each part of the work in the CPU time of adding scans.
json::object sample(const LaserDrive& drive, Poses poses) {
    const std::vector<Stage> stages{
        {"points of scans", {"scan_matching::points_of("}},
        {"local maps of keyframes", {"TrajectoryEstimator::begin_tracking("}},
        {"tracking", {"slam::Tracker::", "slam::candidates_of("}},
        {"optimisation", {"slam::optimize(", "slam::optimize_gradually(", "KeyframeGraph::optimize"}},
        {"stretch tests", {"slam::accept_stretch("}},
        {"loop search", {"slam::LoopSearch::"}},
        {"search for places", {"slam::FragmentSearch::"}},
        {"poses that maps show", {"localization::RobotPoses::", "localization::SessionPoses::"}},
        {"integration", {"mapping::Projection::apply("}},
    };
    MeasuredMaps maps(drive, poses);
    StageSampler sampler;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) maps.add_next();
    json::object shares;
    for (const auto& [name, share] : sampler.shares(stages)) shares[name] = share;
    return shares;
}

/// Returns what a robot that stands for ten minutes adds.
json::object stand(std::size_t driving, std::size_t standing, Poses poses) {
    const LaserDrive drive = simulated_drive(poses, driving, standing);
    MeasuredMaps maps(drive, poses);
    for (std::size_t n = 0; n < driving; ++n) maps.add_next();
    json::object before = graph_json(maps.poses());
    const double allocated_before = allocated_bytes();
    for (std::size_t n = 0; n < standing; ++n) maps.add_next();
    return {{"scans", standing},
            {"before", std::move(before)},
            {"after", graph_json(maps.poses())},
            {"allocated_bytes", allocated_bytes() - allocated_before}};
}

} // namespace
} // namespace scanloom::bench

/// localization_bench measure|sample|stand map|odometry|none SCANS [LOG]: prints figures as JSON.
int main(int argc, char** argv) {
    using namespace scanloom;
    const std::string_view what = argc > 1 ? argv[1] : "";
    const auto poses = find_poses(argc > 2 ? argv[2] : "");
    const std::size_t most = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 0;
    if (argc < 4 || argc > 5 || !poses || most == 0) bench::fail("takes measure|sample|stand POSES SCANS [LOG]");
    if (what == "stand") {
        std::puts(boost::json::serialize(bench::stand(std::min(most, bench::kDriveBefore), most, *poses)).c_str());
        return 0;
    }
    auto drive = argc == 5 ? bench::drive_of_log(argv[4], *poses, most)
                           : bench::simulated_drive(*poses, std::min(most, bench::kSimulatedScans), 0);
    if (!drive) bench::fail(drive.error().message);
    const auto figures = what == "sample" ? bench::sample(*drive, *poses) : bench::measure(*drive, *poses);
    std::puts(boost::json::serialize(figures).c_str());
    return 0;
}
