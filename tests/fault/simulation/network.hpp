#pragma once

#include "tests/fault/simulation/world.hpp"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::simulation {

/// A time in which no data is delivered; data sent meanwhile arrives at its end.
struct Pause {
    Time from;
    Time until;
};

/// The faults of a network, until calm(): the probabilities for each connection, and faults of all connections at once.
struct NetworkTrouble {
    double cut = 0.0;                ///< the connection ends for both sides at some moment
    double silent = 0.0;             ///< delivers no more data after some moment, without a notification
    double deaf = 0.0;               ///< likewise, but in one direction only
    double stall = 0.0;              ///< delivers no data for some time, then all of it
    double refuse = 0.0;             ///< the connection is not established
    double forge = 0.0;              ///< delivers some pieces twice, and some in another order
    std::vector<Pause> partitions{}; ///< between all robots and the server; no connection is established meanwhile
};

enum class Side { kRobot, kServer };

/// A connection between a robot and the server. Data sent by one side arrives at the other in order, delayed, and
/// divided into different pieces.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    struct Ears {
        std::function<void(std::string_view)> on_bytes;
        std::function<void()> on_closed; ///< called when the other side or the network closes the connection
    };

    /// @return null if the connection cannot be established
    [[nodiscard]] static std::shared_ptr<Connection> make(World& world, const NetworkTrouble& trouble);

    void listen(Side side, Ears ears) { ears_[index(side)] = std::move(ears); }
    void send(Side from, std::string bytes);

    /// Closes this side. Data sent before arrives; this side receives no more data.
    void close(Side from);

    /// Removes this side's machine. This side receives no more data; the other side may or may not be notified.
    void vanish(Side from);

private:
    Connection(World& world, const NetworkTrouble& trouble);
    [[nodiscard]] static std::size_t index(Side side) { return side == Side::kRobot ? 0 : 1; }
    [[nodiscard]] static Side other(Side side) { return side == Side::kRobot ? Side::kServer : Side::kRobot; }
    [[nodiscard]] Time arrival(Side from);
    void deliver(Side to, std::string bytes);
    void hear(Side to, const std::string& bytes);
    void cut();

    World& world_;
    std::array<Ears, 2> ears_;
    std::array<Time, 2> last_arrival_{};                  // by sending side
    std::array<std::optional<std::string>, 2> kept_back_; // by sending side: sent after the next piece
    Duration latency_;
    std::vector<Pause> pauses_;                                    // sorted by their start
    std::array<Time, 2> silent_from_ = {Time::max(), Time::max()}; // by sending side
    double forge_ = 0.0;
    bool is_cut_ = false;
};

} // namespace scanloom::simulation
