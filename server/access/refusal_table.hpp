#pragma once

#include "server/access/refusal.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace scanloom::access {

/// Limits the log lines about refusals, so that refused clients cannot fill the log. For each address, port and reason
/// the first refusal is reported at once, and later ones in at most one line per minute with their count.
///
/// Bounds: kAddressesMax entries. Refusals beyond are reported together, with the address kOthers.
/// All times are in seconds of a monotonic clock.
class RefusalTable {
public:
    static constexpr std::size_t kAddressesMax = 1024;
    static constexpr double kPauseSeconds = 60.0;
    static constexpr std::string_view kOthers = "others";

    /// A log line about refusals with the same address, port and reason.
    struct Line {
        Refusal newest;
        std::uint64_t count = 0; ///< since the last line

        friend bool operator==(const Line&, const Line&) = default;
    };

    /// Records a refusal.
    /// @return the lines to log now
    [[nodiscard]] std::vector<Line> note(Refusal refusal, double now);

    /// Returns the lines that are due. Call it periodically, so that they appear even if no further refusal occurs.
    [[nodiscard]] std::vector<Line> due(double now);

    /// Returns the lines that have not been reported. Call it before destruction.
    [[nodiscard]] std::vector<Line> rest();

private:
    using Key = std::tuple<std::string, Port, Reason>;
    struct Kept {
        Refusal newest;
        double told = 0.0;        // time of the last line
        std::uint64_t untold = 0; // refusals since then
    };

    void sweep(double now, std::vector<Line>& lines);

    std::map<Key, Kept> kept_;
    double swept_ = 0.0;
};

} // namespace scanloom::access
