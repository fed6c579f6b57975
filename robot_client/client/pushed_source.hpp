#pragma once

#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/wake_signal.hpp"

#include <deque>

namespace scanloom::robot {

/// A source of the scans that its owner pushes.
/// Threads: as for LiveSource, including push() and stop().
class PushedSource final : public LiveSource {
public:
    void push(Observation observation);

    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    /// Ends the source after the scans that were pushed before.
    void stop() override;

    [[nodiscard]] std::size_t waiting() const noexcept { return scans_.size(); }

private:
    std::deque<Observation> scans_;
    bool stopped_ = false;
    WakeSignal added_;
};

} // namespace scanloom::robot
