#pragma once

#include "lab/cluster_draws.hpp"
#include "lab/cluster_plan.hpp"
#include "lab/cluster_result.hpp"
#include "lab/cluster_servers.hpp"
#include "robot_client/uplink/backoff.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanloom::lab::cluster {

/// What a robot does next.
enum class Step : std::uint8_t {
    kAsk,     ///< connects to the server that it has chosen
    kWelcome, ///< is welcomed by it
    kFail,    ///< notices that the connection has failed
};

/// A robot: its choice of servers, and since when it has no acknowledgements.
class Robot {
public:
    /// A robot that starts.
    /// @param first         the first node of its session's order
    /// @param backoff_seed  of its waits
    Robot(std::uint32_t first, std::uint32_t backoff_seed, Time now)
        : servers_(first), backoff_(backoff_seed), since_(now) {}

    [[nodiscard]] std::size_t server() const noexcept { return servers_.current(); }
    [[nodiscard]] bool is_linked() const noexcept { return is_linked_; }

    /// The server has named another one. @return after what time to ask the next server
    /// @param order  of the robot's session, as below
    [[nodiscard]] Time sent_to(std::size_t node, const Order& order) {
        return servers_.choose_another(node, order) ? kAtOnce : pause();
    }

    /// The connection has failed. @return after what time to ask the next server
    [[nodiscard]] Time fail(const Order& order) {
        return servers_.choose_another(std::nullopt, order) ? kAtOnce : pause();
    }

    /// The server acknowledges nothing more since `now`.
    void lose(Cause cause, Time now) {
        is_linked_ = false;
        cause_ = cause;
        since_ = now;
    }

    /// The server has welcomed the robot.
    void settle() {
        servers_.settle();
        backoff_.reset();
        is_linked_ = true;
    }

    [[nodiscard]] Cause cause() const noexcept { return cause_; } ///< of its last wait
    [[nodiscard]] Time since() const noexcept { return since_; }  ///< begin of its last wait

private:
    static constexpr Time kAtOnce{1}; // as kAnswer: events at one moment must not depend on their order

    [[nodiscard]] Time pause() { return std::min(Time(backoff_.next()), servers_.wait_max()); }

    Servers servers_;
    robot::Backoff backoff_;
    Time since_;
    Cause cause_ = Cause::kStart;
    bool is_linked_ = false;
};

/// Times without acknowledgements.
class WaitLog {
public:
    void add(Cause cause, Time waited) { waits_[static_cast<std::size_t>(cause)].push_back(waited); }

    /// Returns the figures of a cause; changes the order of its times.
    [[nodiscard]] Waits waits_of(Cause cause) {
        auto& all = waits_[static_cast<std::size_t>(cause)];
        if (all.empty()) return {};
        const std::size_t rank = (all.size() * 99 + 99) / 100 - 1;
        std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(rank));
        return {all.size(), all[rank], std::ranges::max(all)};
    }

private:
    std::array<std::vector<Time>, kCauses.size()> waits_;
};

} // namespace scanloom::lab::cluster
