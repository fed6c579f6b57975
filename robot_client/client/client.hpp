#pragma once

/// @file
/// The C++ client of a Scanloom server: sends a robot's scans to a session, and plans, explores and localizes there.
///
///     const ClientOptions options{.server = "127.0.0.1:7447", .session = "hall", .robot = "cart"};
///     const auto robot = Client::start(options).value();     // value() throws ErrorException on failure
///     robot->send(laser, scan).value();                      // shared_ptr<Sensor> and Scan; returns at once
///     const Path path = robot->plan({4.0, 2.5}, 5s).value(); // metres in the map frame
///     robot->close(10s).value();                             // waits until all scans are stored

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/limits.hpp"
#include "common/scan/poses.hpp"
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

/// Pose of a robot's odometry frame in the map. The pose of a scan in the map is compose(T_map_odom, T_odom_robot),
/// see pose2.hpp.
struct Location {
    Pose2 T_map_odom;            ///< metres, radians
    double inlier_ratio = 0.0;   ///< share of the observed points that match the map, 0 to 1
    double position_sigma = 0.0; ///< metres; of the sensor's position, in its least certain direction
    double yaw_sigma = 0.0;      ///< radians
    std::uint64_t revision = 0;  ///< of the session's maps that were used
    LocalizationState state = LocalizationState::kGiven; ///< set by the server's corrections, not by locate()
    double explained = 0.0;                              ///< earlier name of inlier_ratio, until 0.3; the same value
    /// Radians: by how much the yaw of the laser's mount seems to be too large, because scans show motions in another
    /// direction than the odometry; nullopt: it seems to be right. Set by the server's corrections, not by locate().
    std::optional<double> mount_yaw_error = {};
};

/// Options of a client. The defaults suit a robot that connects to a server without TLS on the same machine.
struct ClientOptions {
    /// The server's robot port: HOST:PORT or [ADDRESS]:PORT; of several servers that share a store, with commas
    /// between, in any order, and spelled alike by all robots.
    std::string server = "127.0.0.1:7447";
    std::string session;               ///< [A-Za-z0-9_-]{1,64}; created if it does not exist
    std::string robot;                 ///< same characters; name in the session, used by one program at a time
    std::string token;                 ///< for a server that requires one
    std::optional<double> cell_size;   ///< metres, for a new session; an existing session must have the same
    std::optional<double> body_radius; ///< metres; a disc of this radius around the robot's origin holds the robot
    /// What the robot knows of its poses, the same for all its scans. With kOdometry and kNone the server estimates
    /// where scans were taken.
    Poses poses = Poses::kMap;

    bool tls = false;          ///< encrypt the link; the server must be started with TLS
    std::string tls_ca_file;   ///< PEM, enables tls; empty: the system's certificates
    std::string tls_cert_file; ///< PEM, enables tls: for a server that requires client certificates; empty: none
    std::string tls_key_file;  ///< private key of tls_cert_file, without a password; empty: in the same file

    /// Directory that keeps scans until they are stored, also across restarts of this program. Empty: scans are kept in
    /// memory.
    std::filesystem::path spool;
    std::uint64_t spool_bytes_max = std::uint64_t{256} << 20; ///< at least 1 MiB
    std::uint64_t memory_bytes_max = std::uint64_t{8} << 20;  ///< for scans not yet acknowledged; at least 0.1 MiB
    bool drop_newest = false;                 ///< when full; otherwise the oldest unsent scans are dropped
    bool compress = false;                    ///< compress batches: fewer bytes, more CPU time
    std::chrono::milliseconds batch_delay{0}; ///< how long a scan may wait for others to share its batch, at most 60 s

    /// Receives messages for people, for example that the server is unreachable or that scans are dropped. Runs on the
    /// client's thread, which waits for it. It must not call the client and must not throw. Empty: no messages.
    std::function<void(const std::string&)> on_message;
    /// Receives each correction of the robot's poses, with Poses::kOdometry and kNone: after scans of it are in the
    /// maps, at most 20 times a second; see Client::transform(). Runs as on_message, but may call transform(). Empty:
    /// none.
    std::function<void(const Location&)> on_correction;
    std::function<void(const std::string&)> tell; ///< earlier name of on_message, until 0.3; used if that is empty
};

/// Counters of a client at one moment.
struct ClientStatus {
    std::uint64_t acknowledged = 0; ///< scans of this robot that are stored, including those of earlier runs
    std::uint64_t waiting = 0;      ///< scans that are not stored yet, sent or not
    std::uint64_t dropped = 0;      ///< scans lost because there was no room
    std::uint64_t bytes = 0;        ///< sent
    bool is_linked = false;         ///< whether the server has welcomed this robot on a link that is up now
};

/// Options of plan().
struct PlanOptions {
    std::optional<Point2> start;       ///< metres in the map frame; none: the pose of the robot's newest scan
    bool allow_unknown = false;        ///< whether the path may lead through or next to unexplored cells
    std::optional<double> body_radius; ///< metres, 0 to 5; none: ClientOptions::body_radius
    std::optional<double> danger_cost; ///< additional cost of each metre in danger, 0 to 1000; none: 1
};

/// A polyline in the map frame, in metres.
struct Path {
    std::vector<Point2> points; ///< at least 1
    double length = 0.0;        ///< metres
    double cost = 0.0;          ///< metres; each metre in danger counts 1 + danger_cost
    std::uint64_t revision = 0; ///< of the session's maps that were used
};

/// Options of coverage().
struct CoverageOptions {
    std::optional<Point2> start;       ///< as in PlanOptions
    std::optional<double> body_radius; ///< as in PlanOptions; also the width covered on each side of the path
    std::optional<double> spacing; ///< metres between rows, at most 2 * body_radius + cell_size; none: 2 * body_radius
    std::vector<Point2> region;    ///< corners of a polygon, 3 to 4096; none: all free ground
};

/// Adjacent cells in one row of the map: (i, j), (i + 1, j), ... Cell (i, j) has its lower-left corner at (i, j) *
/// cell_size.
struct CellRun {
    std::int32_t j = 0;     ///< row, counted from the origin upwards
    std::int32_t i = 0;     ///< column of the first cell, counted from the origin to the right
    std::int32_t count = 0; ///< cells, at least 1
};

/// A path that covers all free ground.
struct Coverage {
    Path path;                        ///< from the start
    double free_area = 0.0;           ///< square metres of free cells in the region
    double covered_area = 0.0;        ///< square metres of those cells that the path covers
    std::vector<CellRun> unreachable; ///< the remaining free cells; no path reaches them
    double cell_size = 0.0;           ///< metres
};

/// The next exploration goal.
struct ExplorationGoal {
    /// Whether the robot has something to explore.
    enum class Outcome {
        kGoal,          ///< `path` leads to the next goal
        kTakenByOthers, ///< other robots drive to all goals that this robot can reach
        kComplete,      ///< no goal can be reached any more
    };
    Outcome outcome = Outcome::kComplete; ///< decides which members below are set
    std::vector<Point2> path;             ///< with kGoal: path to the goal, metres in the map frame
    Point2 target{0.0, 0.0};              ///< with kGoal: the point to observe from the end of the path
    bool in_danger = false; ///< with kGoal: the path ends near an obstacle because there was no other place to stand
    std::uint32_t given_up = 0; ///< frontier cells no longer counted because robots could not observe them
};

/// Options of locate().
struct LocateOptions {
    /// The robot is no more than `radius` metres from `point` along each axis of the map.
    struct Near {
        Point2 point{0.0, 0.0}; ///< metres in the map frame
        double radius = 0.0;    ///< more than 0, at most 1000
    };
    std::optional<Near> near = {}; ///< none: anywhere in the map
};

/// A robot's connection to a Scanloom server, for use in the robot's own program.
///
/// send() returns at once. A thread of the client sends the scans, keeps them until they are stored, reconnects when
/// the link breaks, and resumes after the last scan that the server has. Only flush(), close() and the requests plan(),
/// next_goal(), coverage() and locate() wait for the network, at most for their `timeout`. After that they return
/// kTimeout: scans are still sent, a request is abandoned.
///
/// Units: metres; radians, counter-clockwise; seconds; ranges in whole millimetres (scan.hpp).
/// Frames: as in Scan and Sensor. Each scan contains the robot's pose in the map frame, unless ClientOptions::poses says
///         otherwise.
/// Errors: a Result is true or holds error() with a code for programs and a message for people (error.hpp). value()
///         throws ErrorException if there is an error.
/// Threads: any thread, several at a time. Scans are stored in the order of the send() calls.
///
/// A request is sent once the scans sent before it are in the server's maps or dropped, so the server knows the robot's
/// pose of the newest scan. At most four requests are open at a time; those of other threads wait for their turn within
/// their own `timeout`. All requests may fail with kInvalidField or kTooLarge if no server accepts the option that the
/// message names, with the server's error, with kTimeout after `timeout`, and with the error that ended the link
/// permanently.
class Client {
public:
    /// Starts the client's thread. The server need not be reachable yet.
    /// @param options  see ClientOptions; all are checked before anything is started
    /// @return the client, which sends scans until it is closed or destroyed
    /// Errors: kInvalidField if an option is invalid; kStoreFailed or kConflict if the spool cannot be opened; errors
    ///         of the TLS files.
    [[nodiscard]] static Result<std::unique_ptr<Client>> start(ClientOptions options);

    /// Stops the client. Scans that are not stored remain in the spool, or are lost without one. Call close() to avoid
    /// that.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Queues a scan and returns at once.
    /// @param sensor  the sensor that took the scan; a changed description is sent to the server
    /// @param scan    its ranges are to_ranges_mm() of metres, one per beam; the client sets its seq. With Poses::kMap its
    ///                pose is T_map_robot in metres and radians; with kOdometry it has no pose, and its odometry is
    ///                T_odom_robot; with kNone it has neither
    /// @return success if the scan was queued, or dropped for lack of room: see ClientStatus::dropped
    /// Errors: kInvalidField or kTooLarge if no server accepts the value that the message names; kOverloaded if the
    ///         client cannot keep up because its disk does not respond; the error that ended the link permanently, e.g.
    ///         kUnauthorized.
    [[nodiscard]] Result<> send(const std::shared_ptr<const Sensor>& sensor, Scan scan);

    /// Waits until all scans sent before this call are stored. Scans that other threads send meanwhile are not waited
    /// for.
    /// @param timeout  longest time to wait, milliseconds; 0: only check
    /// @return success if all these scans are stored
    /// Errors: kTimeout; kOverloaded if scans were dropped for lack of room since the last flush(): the message gives
    ///         their number, all others are stored; the error that ended the link permanently.
    [[nodiscard]] Result<> flush(std::chrono::milliseconds timeout);

    /// Waits until all scans sent before are stored, then closes the link. Further calls of send() fail with kGone.
    /// @param timeout  longest time to wait, milliseconds
    /// @return success if all scans are stored and the link is closed
    /// Errors: as flush(). After kTimeout call it again; after any other error the client is closed.
    [[nodiscard]] Result<> close(std::chrono::milliseconds timeout);

    // Requests.

    /// Plans the cheapest path to a goal.
    /// @param goal      metres in the map frame
    /// @param timeout  longest time to wait, milliseconds
    /// @param options   start, body radius and costs
    /// @return the path, from the start to `goal`, in metres in the map frame
    /// Errors: kNoPath if no path leads there, or without a start if the server has lost the robot: the message says
    ///     which; those of all requests, see Client.
    /// Source: Dijkstra, A note on two problems in connexion with graphs (1959), over the cells; then straightened.
    [[nodiscard]] Result<Path> plan(const Point2& goal, std::chrono::milliseconds timeout,
                                    const PlanOptions& options = {});

    /// Asks for the next exploration goal. The server keeps it for this robot, so that other robots get other goals.
    /// @param timeout  longest time to wait, milliseconds
    /// @return the goal and the path to it, in metres in the map frame; or why there is none
    /// Errors: kNoPath if the robot stands where no path can start, e.g. inside an obstacle, or if the server has lost
    ///     it: then stop, because the robot's goal ends; those of all requests, see Client.
    /// Source: Yamauchi, A frontier-based approach for autonomous exploration (1997).
    [[nodiscard]] Result<ExplorationGoal> next_goal(std::chrono::milliseconds timeout);

    /// Plans a path that covers all free ground, or that of a region.
    /// @param timeout  longest time to wait, milliseconds
    /// @param options   start, body radius, distance of the rows and region
    /// @return the path in metres in the map frame, and the ground that it cannot reach
    /// Errors: kNoPath if no free ground can be reached from the start; those of all requests, see Client.
    /// Source: Choset, Pignon, Coverage path planning: the boustrophedon cellular decomposition (1998).
    [[nodiscard]] Result<Coverage> coverage(std::chrono::milliseconds timeout, const CoverageOptions& options = {});

    /// Finds the robot's pose in the map from laser scans taken at one place. It serves robots without odometry and
    /// robots that lost their position. It needs no scans sent before, and does not store `scans`.
    /// @param sensor   the laser that took all of `scans`
    /// @param scans    one or more, ten are plenty, with at least kLocatePointsMin returns in total; of more than
    ///                 32,768 returns an even selection is used. Scan::pose is the robot's pose in its odometry frame;
    ///                 if it is absent, Scan::odometry is used, and without both the origin
    /// @param timeout  longest time to wait, milliseconds
    /// @param options   part of the map to search
    /// @return the pose of the odometry frame in the map frame, with its uncertainty
    /// Errors: kAmbiguous if several places look alike; kUndetermined if too little of the scans is in the map;
    ///         kNothingMapped if no laser has mapped anything yet (see Scan::begins_map); those of all requests, see
    ///         Client.
    /// Source: Olson, Real-time correlative scan matching (2009), for the search; Censi, An ICP variant using a
    ///         point-to-line metric (2008), for the refinement.
    [[nodiscard]] Result<Location> locate(const std::shared_ptr<const Sensor>& sensor, std::span<const Scan> scans,
                                          std::chrono::milliseconds timeout, const LocateOptions& options = {});
    /// Smallest number of returns that locate() accepts.
    static constexpr std::size_t kLocatePointsMin = kViewPointsMin;

    /// Returns where the robot's odometry frame is in the map by the newest correction of the server. With
    /// Poses::kOdometry, the robot is always where the correction puts its current odometry:
    ///
    ///     const Pose2 T_odom_robot = wheels.pose(); // newer than the newest scan
    ///     if (const auto location = robot->transform()) {
    ///         const Pose2 T_map_robot = compose(location->T_map_odom, T_odom_robot);
    ///         follow(path, T_map_robot);            // a path of plan() or next_goal()
    ///     }
    ///
    /// T_map_odom jumps when the server corrects the poses, for example where a loop closes. With Poses::kNone the
    /// robot itself is its odometry frame, so that T_map_odom is T_map_robot of its newest scan in the maps.
    /// @return the newest correction, in metres and radians, also after its link has ended; nullopt before the first one,
    ///         while the robot is not located in the map that others began, and always with Poses::kMap
    /// Threads: any thread; returns at once.
    [[nodiscard]] std::optional<Location> transform() const;

    /// Reads the counters. Blocks, as the destructor does, while the spool's disk does not respond.
    /// @return the counters at this moment
    [[nodiscard]] ClientStatus status() const;

private:
    class Worker;

    Client(std::unique_ptr<Worker> worker, std::optional<double> cell_size, Poses poses);

    std::unique_ptr<Worker> worker_;
    std::optional<double> cell_size_;
    Poses poses_;
};

} // namespace scanloom::robot
