#pragma once

#include "common/app/standard_error.hpp"
#include "robot_client/source/line_reader.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// One line for people: how many scans are stored, how fast, how long it still takes.
/// `total` is the highest seq there will be, if that is known.
[[nodiscard]] std::string progress_text(const UplinkStatus& status, std::optional<std::uint64_t> total,
                                        std::chrono::duration<double> elapsed);

/// How far a log has been read before its first scan is sent.
[[nodiscard]] std::string reading_text(std::string_view file, const ReadProgress& progress);

/// Why nothing is sent for a while.
[[nodiscard]] std::string pause_text(std::chrono::duration<double> pause);

/// What the program tells while it runs, on stderr. On a terminal the progress stays on one line that is written over;
/// elsewhere it is a plain line every few seconds. No colours, so there is nothing for NO_COLOR to switch off.
/// Nothing ever waits for a reader.
class Console {
public:
    explicit Console(StandardError& out) : out_(out) {}

    /// How often progress() is worth calling.
    [[nodiscard]] std::chrono::milliseconds progress_period() const;

    void progress(std::string_view text);
    void note(std::string_view text);
    /// Leaves the newest progress line standing.
    void finish();

private:
    StandardError& out_;
    bool line_is_open_ = false;
};

} // namespace scanloom::robot
