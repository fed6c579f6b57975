#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

struct ClientOptions {
    std::string server = "127.0.0.1:7447"; ///< the robot port: HOST:PORT, or [ADDRESS]:PORT
    std::string session;                   ///< [A-Za-z0-9_-]{1,64}; made where it does not exist
    std::string robot;                     ///< likewise: its name within the session
    std::string token;
    std::optional<double> cell_size;   ///< metres, for a session that is made
    std::optional<double> body_radius; ///< metres, of a disc around the robot's origin that holds all of it

    bool tls = false;
    std::string tls_ca_file; ///< PEM; empty: what the system trusts

    std::filesystem::path spool; ///< a directory that keeps scans until they are stored; empty: they are kept in memory
    std::uint64_t spool_bytes_max = std::uint64_t{256} << 20;
    std::uint64_t memory_bytes_max = std::uint64_t{8} << 20;
    bool drop_newest = false; ///< when there is no room left; else the oldest that were never sent go
    bool compress = false;
    std::chrono::milliseconds batch_delay{0}; ///< how long a scan may wait for others to be sent with

    /// Hears sentences for people: that the server is away, that scans are dropped. Called on the client's thread.
    std::function<void(const std::string&)> tell = [](const std::string&) {};
};

struct ClientStatus {
    std::uint64_t acknowledged = 0; ///< scans of this robot that are stored, those of earlier runs included
    std::uint64_t waiting = 0;      ///< scans that are not, sent or not
    std::uint64_t dropped = 0;      ///< scans that are lost for want of room
    std::uint64_t bytes = 0;        ///< sent
    bool is_linked = false;
};

/// Where to explore next.
struct ExplorationGoal {
    enum class Outcome { kGoal, kTakenByOthers, kComplete };
    Outcome outcome = Outcome::kComplete;
    std::vector<Point2> path; ///< with kGoal: the way there, metres in the map frame
    Point2 target{0.0, 0.0};  ///< with kGoal: what to look at from its end
};

/// A robot's link to a Scanloom server, for the robot's own program.
///
/// Scans are handed over and forgotten: a thread of the client's own sends them, keeps what is not stored, connects
/// again when the link breaks, and resumes behind what the server has. Nothing waits for the network but flush(),
/// close(), plan() and next_goal().
/// Thread  any, several at a time.
class Client {
public:
    /// Starts; the server may come later.
    /// Errors  kInvalidField: an option that cannot be; those of the spool and of TLS files.
    [[nodiscard]] static Result<std::unique_ptr<Client>> start(ClientOptions options);

    /// Without close(), scans that are not stored are lost, or left to the spool.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Hands a scan over. Its seq is the client's business; scan.pose is the robot's in the map frame, ranges are
    /// to_range_mm() of metres. The same sensor may be given each time; a change of it is told to the server.
    /// Errors  kInvalidField, kTooLarge: what no server would take, the message names the field; what ended the link for
    ///         good, e.g. kUnauthorized; kOverloaded: the client does not keep up, as its disk stands still.
    [[nodiscard]] Result<> send(const std::shared_ptr<const Sensor>& sensor, Scan scan);

    /// Waits until all scans that were handed over are stored. Errors  kTimeout; what ended the link for good.
    [[nodiscard]] Result<> flush(std::chrono::milliseconds patience);

    /// Waits as flush() does and says goodbye. Nothing can be sent from then on. Errors  as of flush().
    [[nodiscard]] Result<> close(std::chrono::milliseconds patience);

    /// The cheapest way from where the robot's newest scan was taken. Errors  the server's; kTimeout.
    [[nodiscard]] Result<std::vector<Point2>> plan(const Point2& goal, std::chrono::milliseconds patience);

    /// Where to explore next, once all scans handed over are in the maps. Errors  the server's; kTimeout.
    [[nodiscard]] Result<ExplorationGoal> next_goal(std::chrono::milliseconds patience);

    [[nodiscard]] ClientStatus status() const;

private:
    class Worker;

    explicit Client(std::unique_ptr<Worker> worker);

    std::unique_ptr<Worker> worker_;
};

} // namespace scanloom::robot
