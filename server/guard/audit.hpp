#pragma once

#include "common/net/tls.hpp"
#include "server/access/refusal_table.hpp"
#include "server/metrics/metrics.hpp"

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace scanloom::guard {

/// Seconds of a clock that is never put back.
[[nodiscard]] double steady_seconds();

/// Tells the log who was refused and counts it. Secrets are never given to it.
///
/// A line: event=refused port=robot who=10.0.0.7 token=depot reason=wrong_session session=lab count=1
/// Thread  any.
class Audit {
public:
    explicit Audit(metrics::RefusalCounters& counters, std::function<double()> now = steady_seconds)
        : counters_(counters), now_(std::move(now)) {}

    /// What was not told yet is told in the end.
    ~Audit();
    Audit(const Audit&) = delete;
    Audit& operator=(const Audit&) = delete;

    void note(access::Refusal refusal);

    /// Of who comes without a certificate that is asked for.
    void note(access::Port port, const std::string& who, net::ClientFault fault);

    /// Tells what has waited long enough. Call it now and then.
    void tell_what_is_due();

    /// Of a link that ended before anybody was let in: whether the log is told. A line a second at most, so that nobody
    /// fills a disk by knocking.
    /// @return how many have not been told since the last one; nothing: nor is this one.
    [[nodiscard]] std::optional<std::uint64_t> take_line_of_stranger();

private:
    metrics::RefusalCounters& counters_;
    std::function<double()> now_;
    std::mutex mutex_; // guards what follows
    access::RefusalTable table_;
    std::optional<double> stranger_told_; // when
    std::uint64_t strangers_untold_ = 0;  // since
};

} // namespace scanloom::guard
