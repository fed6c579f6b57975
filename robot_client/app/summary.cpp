#include "robot_client/app/summary.hpp"

#include <boost/json/serialize.hpp>
#include <fmt/format.h>

namespace scanloom::robot {

std::string summary_json(const Summary& summary) {
    const UplinkStatus& status = summary.status;
    const auto field = [](std::string_view name, const std::string& text) {
        return text.empty() ? "" : fmt::format(R"(,"{}":{})", name, boost::json::serialize(text));
    };
    return fmt::format(
        R"({{"scans":{},"acknowledged":{},"stored_before":{},"sent":{},"bytes":{},"seconds":{:.3f},)"
        R"("skipped_lines":{},"reconnects":{},"waiting":{},"dropped":{},"session":"{}","robot":"{}","source":"{}","order":"{}"{}}})",
        summary.scan_count.value_or(status.last), status.acknowledged, status.resumed_after, status.sent, status.bytes,
        summary.elapsed.count(), summary.skipped_lines, status.reconnects, status.waiting, status.dropped,
        summary.session, summary.robot, summary.source, summary.order,
        field("remarks", summary.remarks) + field("error", summary.error));
}

} // namespace scanloom::robot
