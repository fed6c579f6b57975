#include "robot_client/app/summary.hpp"

#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>

#include <cmath>

namespace scanloom::robot {

std::string summary_json(const Summary& summary) {
    const UplinkStatus& status = summary.status;
    const std::uint64_t before = summary.is_recording ? 0 : status.resumed_after;
    return boost::json::serialize(boost::json::object{
        {"scans", status.last - before},
        {"acknowledged", status.acknowledged - before},
        {"bytes", status.bytes},
        {"seconds", std::round(summary.elapsed.count() * 1000.0) / 1000.0},
        {"resumed_after", status.resumed_after},
        {"skipped_lines", summary.skipped_lines},
        {"reconnects", status.reconnects},
        {"session", summary.session},
        {"robot", summary.robot},
    });
}

} // namespace scanloom::robot
