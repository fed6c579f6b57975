#include "load/core/course.hpp"

#include <cassert>

namespace scanloom::load {

Course make_course(const Sensor& sensor, const std::vector<Scan>& scans, double stamp_rate, std::uint32_t batch) {
    assert(!scans.empty() && batch > 0 && stamp_rate > 0.0);
    Course course;
    course.scans.reserve(scans.size());
    for (const Scan& scan : scans) course.scans.emplace_back(scan);
    course.beams = scans.front().ranges.size();
    course.sensor = std::make_shared<const Sensor>(sensor);
    course.stamp_rate = stamp_rate;
    course.batch = batch;
    return course;
}

wire::NumberedScan scan_at(const Course& course, std::size_t first, std::uint64_t seq) noexcept {
    const auto place = (first + (seq - 1)) % course.scans.size();
    return {&course.scans[place], seq, static_cast<double>(seq - 1) / course.stamp_rate};
}

} // namespace scanloom::load
