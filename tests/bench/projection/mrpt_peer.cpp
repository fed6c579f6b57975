#include "tests/bench/projection/peers.hpp"

#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

namespace scanloom::bench {
namespace {

class Mrpt final : public Mapper {
public:
    explicit Mrpt(const Column& column)
        : sensor_(column.sensor), grid_(static_cast<float>(-column.half_side), static_cast<float>(column.half_side),
                                        static_cast<float>(-column.half_side), static_cast<float>(column.half_side),
                                        static_cast<float>(column.cell_size)) {
        const auto beams = beam_count(sensor_.angles);
        grid_.insertionOptions.maxDistanceInsertion = static_cast<float>(sensor_.range_max);
        grid_.insertionOptions.considerInvalidRangesAsFreeSpace = true;
        const double spread = beam_angle(sensor_.angles, beams - 1) - beam_angle(sensor_.angles, 0);
        observation_.aperture = static_cast<float>(spread);
        observation_.rightToLeft = true;
        observation_.maxRange = static_cast<float>(sensor_.range_max);
        observation_.resizeScan(beams);
        // Its scans are centred on the robot's heading; ours need not be.
        turn_ = beam_angle(sensor_.angles, 0) + spread / 2.0;
    }

    void insert(const Scan& scan) override {
        for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
            const bool is_hit = scan.ranges[beam] != kNoReturn && scan.ranges[beam] * 0.001 < sensor_.range_max;
            observation_.setScanRange(beam, static_cast<float>(is_hit ? scan.ranges[beam] * 0.001 : sensor_.range_max));
            observation_.setScanRangeValidity(beam, is_hit && scan.ranges[beam] != kInvalidRange);
        }
        const mrpt::poses::CPose3D pose(scan.pose.x, scan.pose.y, 0.0, scan.pose.yaw + turn_, 0.0, 0.0);
        grid_.insertObservation(observation_, pose);
    }

private:
    const Sensor& sensor_;
    mrpt::maps::COccupancyGridMap2D grid_;
    mrpt::obs::CObservation2DRangeScan observation_;
    double turn_;
};

} // namespace

std::vector<Peer> mrpt_peer() {
    return {{"mrpt", [](const Column& column) { return std::make_unique<Mrpt>(column); }}};
}

} // namespace scanloom::bench
