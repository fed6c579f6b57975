#include "robot_client/app/summary.hpp"

#include <fmt/format.h>

namespace scanloom::robot {

std::string summary_json(const Summary& summary) {
    const UplinkStatus& status = summary.status;
    const std::uint64_t before = summary.is_recording ? 0 : status.resumed_after;
    // Names are valid ones (is_valid_name): nothing in them needs escaping.
    return fmt::format(R"({{"scans":{},"acknowledged":{},"bytes":{},"seconds":{:.3f},"resumed_after":{},)"
                       R"("skipped_lines":{},"reconnects":{},"session":"{}","robot":"{}"}})",
                       status.last - before, status.acknowledged - before, status.bytes, summary.elapsed.count(),
                       status.resumed_after, summary.skipped_lines, status.reconnects, summary.session, summary.robot);
}

} // namespace scanloom::robot
