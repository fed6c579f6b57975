#include "robot_client/app/progress.hpp"

#include <fmt/format.h>

namespace scanloom::robot {

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

} // namespace scanloom::robot
