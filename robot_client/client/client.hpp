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
#include <span>
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
    std::string tls_ca_file;   ///< PEM, and sets tls; empty: what the system trusts
    std::string tls_cert_file; ///< PEM, and sets tls: shown to a server that asks for one; empty: none
    std::string tls_key_file;  ///< its key, without a password; empty: in the same file

    /// A directory that keeps scans until they are stored, also when this program ends before. Empty: memory keeps
    /// them.
    std::filesystem::path spool;
    std::uint64_t spool_bytes_max = std::uint64_t{256} << 20; ///< 1 MiB at least
    std::uint64_t memory_bytes_max = std::uint64_t{8} << 20;  ///< of scans not acknowledged; 0.1 MiB at least
    bool drop_newest = false;                 ///< when there is no room left; else the oldest that were never sent go
    bool compress = false;                    ///< what is sent: fewer bytes, more work
    std::chrono::milliseconds batch_delay{0}; ///< how long a scan may wait for others, 60 s at most

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

/// What plan() keeps to.
struct PlanOptions {
    std::optional<Point2> start;       ///< metres in the map frame; none: where the robot's newest scan was taken
    bool allow_unknown = false;        ///< whether the way may lead through unexplored cells, and beside them
    std::optional<double> body_radius; ///< metres, 0 to 5; none: ClientOptions::body_radius
    std::optional<double> danger_cost; ///< what a metre in danger costs more than another, 0 to 1000; none: 1
};

/// Straight from point to point, metres in the map frame.
struct Path {
    std::vector<Point2> points; ///< at least 1
    double length = 0.0;        ///< metres
    double cost = 0.0;          ///< metres, those in danger counting 1 + danger_cost
    std::uint64_t revision = 0; ///< of the session's maps it was found on
};

/// What coverage() keeps to.
struct CoverageOptions {
    std::optional<Point2> start;       ///< as of PlanOptions
    std::optional<double> body_radius; ///< likewise; what the way covers to either side, too
    std::optional<double> spacing;     ///< metres between rows, at most two body radii and a cell; none: two body radii
    std::vector<Point2> region;        ///< corners of a polygon, 3 to 4096; none: all free ground
};

/// Cells side by side in a row of the map: (i, j), (i + 1, j) ... Cell (i, j) is the square from (i, j) * cell_size on.
struct CellRun {
    std::int32_t j = 0;
    std::int32_t i = 0;
    std::int32_t count = 0;
};

/// A way over all free ground.
struct Coverage {
    Path path;
    double free_area = 0.0;           ///< square metres of free cells in the region
    double covered_area = 0.0;        ///< square metres of those that the path covers
    std::vector<CellRun> unreachable; ///< the others, which no path reaches
    double cell_size = 0.0;           ///< metres
};

/// Where to explore next.
struct ExplorationGoal {
    enum class Outcome {
        kGoal,          ///< there is somewhere to go
        kTakenByOthers, ///< other robots have all that this one can reach
        kComplete,      ///< nothing can be reached any more
    };
    Outcome outcome = Outcome::kComplete;
    std::vector<Point2> path;   ///< with kGoal: the way there, metres in the map frame
    Point2 target{0.0, 0.0};    ///< with kGoal: what to look at from its end
    bool in_danger = false;     ///< with kGoal: its end is near an obstacle, as there was no other place to stand
    std::uint32_t given_up = 0; ///< cells of frontiers that count no more, as robots looked at them in vain
};

/// What locate() keeps to.
struct LocateOptions {
    /// The robot is no more than `radius` metres from `point` along each axis of the map.
    struct Near {
        Point2 point{0.0, 0.0}; ///< metres, map frame
        double radius = 0.0;    ///< more than 0, at most 1000
    };
    std::optional<Near> near = {}; ///< none: anywhere in the map
};

/// Where a robot's odometry frame is in the map: a scan's pose is T_map_odom times that of the robot in its odometry
/// frame (pose2.hpp: compose()).
struct Location {
    Pose2 T_map_odom;
    double explained = 0.0;      ///< part of what the robot saw that lies on what the map has, 0 to 1
    double position_sigma = 0.0; ///< metres, of where the sensor was, in the direction least known
    double yaw_sigma = 0.0;      ///< radians
    std::uint64_t revision = 0;  ///< of the session's maps it was found on
};

/// A robot's link to a Scanloom server, for the robot's own program.
///
///     const auto robot = Client::start(options).value();
///     robot->send(laser, scan).value(); // as often as the laser turns
///     robot->close(10s).value();
///
/// Scans are handed over and forgotten: a thread of the client's own sends them, keeps what is not stored, connects
/// again when the link breaks, and resumes behind what the server has. Nothing waits for the network but flush(),
/// close() and the questions plan(), next_goal(), coverage() and locate(), each for as long as its caller has patience.
/// What is not done by then is kTimeout, and goes on without the caller: scans are sent, a question is forgotten.
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

    /// Waits until all scans that were handed over before are stored; those that others hand over meanwhile may not be.
    /// Errors  kTimeout; what ended the link for good; kOverloaded: the rest is stored, but as many scans as the
    ///         message says were dropped for want of room since the last flush(), and are lost.
    [[nodiscard]] Result<> flush(std::chrono::milliseconds patience);

    /// Waits as flush() does and says goodbye. Nothing can be sent from then on (kGone).
    /// Errors  as of flush(); after kTimeout it may be tried again, after any other the client is closed.
    [[nodiscard]] Result<> close(std::chrono::milliseconds patience);

    // Questions. Each is asked once the scans handed over before are in the server's maps, or dropped, so that the
    // robot is known to be where the newest of them was taken. Four are open at a time; further ones, of other threads,
    // wait for their turn within their own patience.
    // Errors of all  kInvalidField, kTooLarge: an option that no server would take, by name; the server's, e.g.
    //                kNoPath; kTimeout; what ended the link for good.

    /// The cheapest way to `goal`, metres in the map frame.
    [[nodiscard]] Result<Path> plan(const Point2& goal, std::chrono::milliseconds patience,
                                    const PlanOptions& options = {});

    /// Where to explore next.
    [[nodiscard]] Result<ExplorationGoal> next_goal(std::chrono::milliseconds patience);

    /// A way over all free ground, or that of a region.
    [[nodiscard]] Result<Coverage> coverage(std::chrono::milliseconds patience, const CoverageOptions& options = {});

    /// Where the robot is, told from what a laser saw from one place: for robots without odometry, and such that have
    /// lost their way. No scan needs to have been handed over before; these are not.
    /// Frames  Scan::pose is that of the robot in its odometry frame here; of a robot without odometry the origin.
    /// Shapes  a scan or some, ten are plenty; all of `sensor`, with kLocatePointsMin returns among them. Of more than
    ///         32,768 returns some are taken, evenly.
    /// Errors  the server's are kAmbiguous: several places look alike; kUndetermined: too little of what is seen is in
    ///         the map; kNothingMapped: no laser has seen anything yet (see Scan::begins_map).
    [[nodiscard]] Result<Location> locate(const std::shared_ptr<const Sensor>& sensor, std::span<const Scan> scans,
                                          std::chrono::milliseconds patience, const LocateOptions& options = {});
    static constexpr std::size_t kLocatePointsMin = 20;

    /// Waits, as the destructor does, while the disk of the spool stands still.
    [[nodiscard]] ClientStatus status() const;

private:
    class Worker;

    Client(std::unique_ptr<Worker> worker, std::optional<double> cell_size);

    std::unique_ptr<Worker> worker_;
    std::optional<double> cell_size_;
};

} // namespace scanloom::robot
