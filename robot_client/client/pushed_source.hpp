#pragma once

#include "robot_client/source/live_source.hpp"
#include "robot_client/uplink/bell.hpp"

#include <deque>

namespace scanloom::robot {

/// Scans that somebody hands over. Thread: as of LiveSource, push() and stop() included.
class PushedSource final : public LiveSource {
public:
    void push(Observation observation);

    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    /// What was handed over before is still given.
    void stop() override;

    [[nodiscard]] std::size_t waiting() const noexcept { return scans_.size(); }

private:
    std::deque<Observation> scans_;
    bool stopped_ = false;
    Bell bell_;
};

} // namespace scanloom::robot
