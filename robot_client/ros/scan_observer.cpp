#include "robot_client/ros/scan_observer.hpp"

#include "common/scan/limits.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace scanloom::robot {

Observation ScanObserver::observe(const RosLaserScan& message, RosTime recorded, std::uint32_t id,
                                  const std::string& topic, const RangeMeaning& meaning, const ScanPlace& place,
                                  Poses poses) {
    Sensor sensor = sensor_of(message, meaning, place.mount);
    sensor.id = id;
    sensor.name = topic.substr(0, kNameBytesMax);
    Observation observation{sensor_like(std::move(sensor)), scan_of(message, recorded, meaning)};
    observation.scan.sensor = id;
    set_pose(observation.scan, poses, place.pose);
    return observation;
}

/// Returns a sensor that is sent already, or the given one. Scans may differ in their number of beams.
std::shared_ptr<const Sensor> ScanObserver::sensor_like(Sensor wanted) {
    constexpr std::size_t kRemembered = 16;
    const auto same = [&](const std::shared_ptr<const Sensor>& known) {
        Sensor other = wanted;
        std::get<UniformAngles>(other.angles).count = std::get<UniformAngles>(known->angles).count;
        return other == *known;
    };
    const auto known = std::ranges::find_if(sensors_, same);
    if (known != sensors_.end()) return *known;
    if (sensors_.size() == kRemembered) sensors_.erase(sensors_.begin());
    return sensors_.emplace_back(std::make_shared<const Sensor>(std::move(wanted)));
}

} // namespace scanloom::robot
