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
    std::string robot;                     ///< likewise: its name within the session, of one program at a time
    std::string token;                     ///< for a server that asks for one
    std::optional<double> cell_size;       ///< metres, of a session that is made; one that exists must have the same
    std::optional<double> body_radius;     ///< metres, of a disc around the robot's origin that holds all of it

    bool tls = false;
    std::string tls_ca_file; ///< PEM, and sets tls; empty: what the system trusts

    /// A directory that keeps scans until they are stored, also when this program ends before. Empty: memory keeps
    /// them.
    std::filesystem::path spool;
    std::uint64_t spool_bytes_max = std::uint64_t{256} << 20;
    std::uint64_t memory_bytes_max = std::uint64_t{8} << 20; ///< of scans that wait to be sent, or to be acknowledged
    bool drop_newest = false;                 ///< when there is no room left; else the oldest that were never sent go
    bool compress = false;                    ///< what is sent: fewer bytes, more work
    std::chrono::milliseconds batch_delay{0}; ///< how long a scan may wait for others to be sent with

    /// Hears sentences for people: that the server is away, that scans are dropped. Called on the client's thread,
    /// which waits for it; it must not call the client, nor throw.
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
    enum class Outcome {
        kGoal,          ///< there is somewhere to go
        kTakenByOthers, ///< other robots have all that this one can reach
        kComplete,      ///< nothing can be reached any more
    };
    Outcome outcome = Outcome::kComplete;
    std::vector<Point2> path; ///< with kGoal: the way there, metres in the map frame (x() and y())
    Point2 target{0.0, 0.0};  ///< with kGoal: what to look at from its end
};

/// A robot's link to a Scanloom server, for the robot's own program.
///
///     const auto robot = Client::start(options).value();
///     robot->send(laser, scan).value(); // as often as the laser turns
///     robot->close(10s).value();
///
/// Scans are handed over and forgotten: a thread of the client's own sends them, keeps what is not stored, connects
/// again when the link breaks, and resumes behind what the server has. Nothing waits for the network but flush(),
/// close(), plan() and next_goal().
///
/// Units   metres, radians counter-clockwise, seconds; ranges in whole millimetres (scan.hpp).
/// Frames  those of Scan and Sensor: every scan comes with the robot's pose in the map frame.
/// Errors  a Result is true, or holds error(): a code for programs, a sentence for people (error.hpp). value() throws it
///         as ErrorException where there is one.
/// Thread  any, several at a time. Scans of several threads are stored in the order in which send() took them.
class Client {
public:
    /// Starts; the server may come later.
    /// Errors  kInvalidField: an option that cannot be; those of the spool and of TLS files.
    [[nodiscard]] static Result<std::unique_ptr<Client>> start(ClientOptions options);

    /// Without close(), scans that are not stored are lost, or left to the spool.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Hands a scan over and returns at once. Its seq is the client's business; its ranges are to_ranges_mm() of
    /// metres, one a beam. The same sensor may be given each time; a change of it is told to the server.
    /// Errors  kInvalidField, kTooLarge: what no server would take, the message names the field; what ended the link for
    ///         good, e.g. kUnauthorized; kOverloaded: the client does not keep up, as its disk stands still.
    [[nodiscard]] Result<> send(const std::shared_ptr<const Sensor>& sensor, Scan scan);

    /// Waits until all scans that were handed over are stored. Errors  kTimeout; what ended the link for good.
    [[nodiscard]] Result<> flush(std::chrono::milliseconds patience);

    /// Waits as flush() does and says goodbye. Nothing can be sent from then on (kGone). Errors  as of flush().
    [[nodiscard]] Result<> close(std::chrono::milliseconds patience);

    /// The cheapest way to `goal`, metres in the map frame, from where the robot's newest scan was taken.
    /// Errors  the server's, e.g. kNoPath; kTimeout.
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
