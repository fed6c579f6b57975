#include "robot_client/app/summary.hpp"

#include <fmt/format.h>

namespace scanloom::robot {

std::string summary_json(const Summary& summary) {
    const UplinkStatus& status = summary.status;
    return fmt::format(R"({{"scans":{},"acknowledged":{},"stored_before":{},"sent":{},"bytes":{},"seconds":{:.3f},)"
                       R"("skipped_lines":{},"reconnects":{},"session":"{}","robot":"{}","source":"{}","order":"{}"}})",
                       status.last, status.acknowledged, status.resumed_after, status.sent, status.bytes,
                       summary.elapsed.count(), summary.skipped_lines, status.reconnects, summary.session,
                       summary.robot, summary.source, summary.order);
}

} // namespace scanloom::robot
