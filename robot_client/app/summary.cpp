#include "robot_client/app/summary.hpp"

#include <boost/json/serialize.hpp>
#include <fmt/format.h>

namespace scanloom::robot {

std::string summary_json(const Summary& summary) {
    const UplinkStatus& status = summary.status;
    const auto field = [](std::string_view name, const std::string& text) {
        return text.empty() ? "" : fmt::format(R"(,"{}":{})", name, boost::json::serialize(text));
    };
    const std::string skipped =
        summary.skipped_lines ? fmt::format(R"("skipped_lines":{},)", *summary.skipped_lines) : std::string();
    const std::uint64_t taken = status.last + status.waiting + status.dropped;
    return fmt::format(
        R"({{"scans":{},"acknowledged":{},"stored_before":{},"sent":{},"bytes":{},"seconds":{:.3f},{}"reconnects":{},)"
        R"("waiting":{},"dropped":{},"session":"{}","robot":"{}","source":"{}"{}}})",
        summary.scan_count.value_or(taken), status.acknowledged, status.resumed_after, status.sent, status.bytes,
        summary.elapsed.count(), skipped, status.reconnects, status.waiting, status.dropped, summary.session,
        summary.robot, summary.source,
        field("order", std::string(summary.order)) + field("remarks", summary.remarks) + field("error", summary.error));
}

} // namespace scanloom::robot
