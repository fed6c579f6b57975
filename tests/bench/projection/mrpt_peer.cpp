#include "tests/bench/projection/peers.hpp"

#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

namespace scanloom::bench {
namespace {

class Mrpt final : public Mapper {
public:
    explicit Mrpt(const Column& column)
        : grid_(static_cast<float>(-column.half_side), static_cast<float>(column.half_side),
                static_cast<float>(-column.half_side), static_cast<float>(column.half_side),
                static_cast<float>(column.cell_size)) {
        grid_.insertionOptions.maxDistanceInsertion = static_cast<float>(column.sensor.range_max);
        grid_.insertionOptions.considerInvalidRangesAsFreeSpace = true;
        for (const Scan& scan : column.scans) observations_.push_back(observation_of(scan, column.sensor));
    }

    void insert(const Scan& scan) override {
        const auto& [observation, pose] = observations_[scan.seq - 1];
        grid_.insertObservation(observation, pose);
    }

private:
    /// A scan in MRPT's format, prepared before the measurement so that it adds no cost.
    struct Observation {
        mrpt::obs::CObservation2DRangeScan scan;
        mrpt::poses::CPose3D pose;
    };

    static Observation observation_of(const Scan& scan, const Sensor& sensor) {
        const auto beams = beam_count(sensor.angles);
        const double spread = beam_angle(sensor.angles, beams - 1) - beam_angle(sensor.angles, 0);
        // MRPT's scans are centred on the robot's heading; ours may not be.
        const double turn = beam_angle(sensor.angles, 0) + spread / 2.0;
        Observation made{{}, {scan.pose->x, scan.pose->y, 0.0, scan.pose->yaw + turn, 0.0, 0.0}};
        made.scan.aperture = static_cast<float>(spread);
        made.scan.rightToLeft = true;
        made.scan.maxRange = static_cast<float>(sensor.range_max);
        made.scan.resizeScan(beams);
        for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
            const bool is_hit = scan.ranges[beam] != kNoReturn && scan.ranges[beam] * 0.001 < sensor.range_max;
            made.scan.setScanRange(beam, static_cast<float>(is_hit ? scan.ranges[beam] * 0.001 : sensor.range_max));
            made.scan.setScanRangeValidity(beam, is_hit && scan.ranges[beam] != kInvalidRange);
        }
        return made;
    }

    mrpt::maps::COccupancyGridMap2D grid_;
    std::vector<Observation> observations_;
};

} // namespace

std::vector<Peer> mrpt_peer() {
    return {{"mrpt", [](const Column& column) { return std::make_unique<Mrpt>(column); }}};
}

std::string mrpt_version() { return MRPT_PEER_VERSION; }

} // namespace scanloom::bench
