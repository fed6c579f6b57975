#include "robot_client/app/progress.hpp"

#include <boost/json/serialize.hpp>
#include <boost/json/value_from.hpp>
#include <fmt/format.h>

namespace scanloom::robot {

double RecentRate::update(std::chrono::duration<double> now, std::uint64_t count) {
    samples_.push_back({now, count});
    while (samples_.size() > 1 && now - samples_[1].at >= kWindow) samples_.pop_front();
    const Sample& first = samples_.front();
    const double passed = (now - first.at).count();
    return passed > 0.0 && count > first.count ? static_cast<double>(count - first.count) / passed : 0.0;
}

std::string progress_text(const UplinkStatus& status, std::optional<std::uint64_t> total, double rate,
                          std::string_view remarks) {
    std::string text = total ? fmt::format("{} of {} scans stored", status.acknowledged, *total)
                             : fmt::format("{} scans stored", status.acknowledged);
    text += fmt::format(", {:.0f} a second", rate);
    if (status.next_scan_in) {
        text += fmt::format(", next scan in {}", as_clock(status.next_scan_in->count()));
    } else if (total && rate > 0.0 && *total >= status.acknowledged) {
        text += fmt::format(", {} left", as_clock(static_cast<double>(*total - status.acknowledged) / rate));
    }
    const std::uint64_t waiting = status.last - status.acknowledged + status.waiting;
    if (!status.is_linked) text += fmt::format(", not connected, {} waiting", waiting);
    if (status.is_linked && status.waiting > 0) text += fmt::format(", {} waiting", waiting);
    if (status.dropped > 0) text += fmt::format(", {} DROPPED for lack of space", status.dropped);
    if (!remarks.empty()) text += fmt::format(", {}", remarks);
    return text;
}

std::string reading_text(std::string_view file, const ReadProgress& progress) {
    constexpr double kBytesPerMegabyte = 1e6;
    return fmt::format("{}: {:.1f} of {:.1f} MB read", file, static_cast<double>(progress.bytes) / kBytesPerMegabyte,
                       static_cast<double>(progress.bytes_total) / kBytesPerMegabyte);
}

std::string pause_text(std::chrono::duration<double> pause) {
    return fmt::format("the next scan is due in {}; use --speed 0 to send without waiting", as_clock(pause.count()));
}

std::string summary_json(const Summary& summary) {
    const UplinkStatus& status = summary.status;
    const auto field = [](std::string_view name, const std::string& text) {
        return text.empty() ? "" : fmt::format(R"(,"{}":{})", name, boost::json::serialize(text));
    };
    std::string skipped =
        summary.skipped_lines ? fmt::format(R"("skipped_lines":{},)", *summary.skipped_lines) : std::string();
    if (const auto& left_out = summary.left_out) {
        skipped +=
            fmt::format(R"("skipped":{},"lost_parts":{},)",
                        boost::json::serialize(boost::json::value_from(left_out->skipped)), left_out->lost_parts);
    }
    const std::uint64_t taken = status.last + status.waiting + status.dropped;
    return fmt::format(
        R"({{"scans":{},"acknowledged":{},"stored_before":{},"sent":{},"bytes":{},"seconds":{:.3f},{}"reconnects":{},)"
        R"("waiting":{},"dropped":{},"session":"{}","robot":"{}","source":"{}"{}}})",
        summary.scan_count.value_or(taken), status.acknowledged, status.resumed_after, status.sent, status.bytes,
        summary.elapsed.count(), skipped, status.reconnects, status.waiting, status.dropped, summary.session,
        summary.robot, summary.source,
        field("order", std::string(summary.order)) + field("localization", std::string(summary.localization)) +
            field("remarks", summary.remarks) + field("error", summary.error));
}

} // namespace scanloom::robot
