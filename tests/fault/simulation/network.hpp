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

/// A while in which nothing is carried; what was sent arrives when it has ended.
struct Pause {
    Time from;
    Time until;
};

/// What a network does wrong, until the world is calm: probabilities of each connection, and what befalls all at once.
struct NetworkTrouble {
    double cut = 0.0;                ///< ends, at some moment, for both sides
    double silent = 0.0;             ///< carries nothing more from some moment on, and tells nobody
    double deaf = 0.0;               ///< the same, but in one direction only
    double stall = 0.0;              ///< carries nothing for a while, and all of it then
    double refuse = 0.0;             ///< is not made
    double forge = 0.0;              ///< carries some pieces twice, and some in another order
    std::vector<Pause> partitions{}; ///< of all robots from the server; no connection is made meanwhile
};

enum class Side { kRobot, kServer };

/// A connection between a robot and the server. What one side sends arrives at the other in order, late, and cut into
/// other pieces.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    struct Ears {
        std::function<void(std::string_view)> on_bytes;
        std::function<void()> on_closed; ///< by the other side, or by the network
    };

    /// @return null: it cannot be made.
    [[nodiscard]] static std::shared_ptr<Connection> make(World& world, const NetworkTrouble& trouble);

    void listen(Side side, Ears ears) { ears_[index(side)] = std::move(ears); }
    void send(Side from, std::string bytes);

    /// What was sent before arrives; nothing is heard any more on this side.
    void close(Side from);

    /// The machine is gone: nothing is heard any more on this side, and the other one learns it, or not.
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
    std::array<Time, 2> last_arrival_{};                  // by the side that sends
    std::array<std::optional<std::string>, 2> kept_back_; // likewise: goes behind the next
    Duration latency_;
    std::vector<Pause> pauses_;                                    // by their beginning
    std::array<Time, 2> silent_from_ = {Time::max(), Time::max()}; // by the side that sends
    double forge_ = 0.0;
    bool is_cut_ = false;
};

} // namespace scanloom::simulation
