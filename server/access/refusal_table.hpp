#pragma once

#include "server/access/refusal.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace scanloom::access {

/// What is told of refusals: of each address and reason the first at once, and then one line a minute at most, with how
/// many there were since. So nobody fills a log by being refused.
///
/// Bounds  kAddressesMax pairs of address and reason are kept apart; those beyond are told together, as of kOthers.
/// Times   seconds of a clock that is never put back.
class RefusalTable {
public:
    static constexpr std::size_t kAddressesMax = 1024;
    static constexpr double kPauseSeconds = 60.0;
    static constexpr std::string_view kOthers = "others";

    /// The newest of some refusals that are alike.
    struct Line {
        Refusal newest;
        std::uint64_t count = 0; ///< since the last line

        friend bool operator==(const Line&, const Line&) = default;
    };

    /// Takes a refusal in. @return what is to be told now.
    [[nodiscard]] std::vector<Line> note(Refusal refusal, double now);

    /// What has waited long enough to be told, also where nobody is refused any more. Call it now and then.
    [[nodiscard]] std::vector<Line> due(double now);

    /// What is not told yet, at the end.
    [[nodiscard]] std::vector<Line> rest();

private:
    using Key = std::tuple<std::string, Port, Reason>;
    struct Kept {
        Refusal newest;
        double told = 0.0;        // when
        std::uint64_t untold = 0; // since then
    };

    void sweep(double now, std::vector<Line>& lines);

    std::map<Key, Kept> kept_;
    double swept_ = 0.0;
};

} // namespace scanloom::access
