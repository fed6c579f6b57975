#include "robot_client/client/client.hpp"

#include "common/scan/limits.hpp"
#include "robot_client/client/checks.hpp"
#include "robot_client/client/worker.hpp"
#include "robot_client/sources/seen_points.hpp"
#include "robot_client/uplink/live_feed.hpp"

#include <fmt/format.h>

#include <random>
#include <utility>

namespace scanloom::robot {

using std::chrono::milliseconds;

namespace {

Result<UplinkOptions> uplink_options(const ClientOptions& options) {
    if (auto ok = check(options); !ok) return ok.error();
    auto servers = net::parse_addresses(options.server);
    if (!servers) return servers.error();
    UplinkOptions uplink;
    uplink.servers = std::move(*servers);
    if (options.tls || !options.tls_ca_file.empty() || !options.tls_cert_file.empty()) {
        auto tls = net::client_tls(options.tls_ca_file, {options.tls_cert_file, options.tls_key_file});
        if (!tls) return tls.error();
        uplink.tls = std::move(*tls);
    }
    uplink.give_up_after = uplink.give_up_after_end = milliseconds(0); // flush() has its own timeout
    uplink.backoff_seed = std::random_device{}();
    uplink.buffer_bytes_max = options.memory_bytes_max;
    uplink.protocol.batch_delay = options.batch_delay;
    uplink.protocol.compress = options.compress;
    uplink.protocol.hello.session = options.session;
    uplink.protocol.hello.robot = options.robot;
    uplink.protocol.hello.token = options.token;
    uplink.protocol.hello.create = SessionOptions{};
    uplink.protocol.hello.create->cell_size = options.cell_size;
    uplink.protocol.hello.client = "scanloom client library";
    uplink.protocol.hello.body_radius = options.body_radius;
    uplink.protocol.hello.poses = options.poses;
    uplink.on_trouble = report_once(options.on_message);
    return uplink;
}

/// Collects the points of the scans of a locate request.
/// Errors: kInvalidField or kTooLarge if no server accepts a value.
Result<SeenPoints> seen_from(const std::shared_ptr<const Sensor>& sensor, std::span<const Scan> scans) {
    if (!sensor) return Error{Errc::kInvalidField, "locate() needs the sensor of the scans"};
    if (sensor->kind != SensorKind::kLaser) {
        return Error{Errc::kInvalidField, "locate() needs laser scans; this sensor is a sonar"};
    }
    SeenPoints seen;
    for (std::size_t n = 0; n < scans.size(); ++n) {
        if (auto ok = check(*sensor, scans[n]); !ok) return prefixed(fmt::format("scans[{}]: ", n), ok.error());
        seen.add(scans[n], *sensor);
    }
    if (seen.count() >= kViewPointsMin) return seen;
    return Error{Errc::kInvalidField,
                 fmt::format("the scans have {} returns; at least {} are needed", seen.count(), kViewPointsMin)};
}

Path from_wire(wire::Path path, std::uint64_t revision) {
    return {std::move(path.points), path.length, path.cost, revision};
}

} // namespace

Result<std::unique_ptr<Client>> Client::start(ClientOptions options) {
    if (!options.on_message) options.on_message = options.tell ? std::move(options.tell) : [](const std::string&) {};
    auto uplink = uplink_options(options);
    if (!uplink) return uplink.error();
    const auto when_full = options.drop_newest ? WhenFull::kDropNewest : WhenFull::kDropOldest;
    auto spool = open_spool_of(options.session, options.robot,
                               {.directory = options.spool,
                                .bytes_max = options.spool_bytes_max,
                                .when_full = when_full,
                                .poses = options.poses},
                               options.on_message);
    if (!spool) return spool.error();
    LiveFeedOptions feed;
    feed.when_full = when_full;
    feed.on_message = std::move(options.on_message);
    auto worker = std::make_unique<Worker>(std::move(*uplink), std::move(*spool), std::move(feed),
                                           std::move(options.on_correction));
    return std::unique_ptr<Client>(new Client(std::move(worker), options.cell_size, options.poses));
}

Client::Client(std::unique_ptr<Worker> worker, std::optional<double> cell_size, Poses poses)
    : worker_(std::move(worker)), cell_size_(cell_size), poses_(poses) {}
Client::~Client() = default;

Result<> Client::send(const std::shared_ptr<const Sensor>& sensor, Scan scan) {
    if (!sensor) return Error{Errc::kInvalidField, "a scan needs its sensor"};
    if (auto ok = check(*sensor, scan); !ok) return ok;
    if (auto ok = check_poses(scan, poses_); !ok) return ok;
    if (cell_size_ && sensor->range_max > kReachCellsMax * *cell_size_) {
        return Error{Errc::kInvalidField,
                     fmt::format("range_max is {} m, more than {} cells of the cell_size {} m, the most that a server "
                                 "takes; use larger cells, or a shorter range",
                                 sensor->range_max, kReachCellsMax, *cell_size_)};
    }
    return worker_->push({sensor, std::move(scan)});
}

Result<> Client::flush(milliseconds timeout) { return worker_->flush(timeout); }
Result<> Client::close(milliseconds timeout) { return worker_->close(timeout); }

Result<Path> Client::plan(const Point2& goal, milliseconds timeout, const PlanOptions& options) {
    wire::PlanRequest request;
    request.goal = goal;
    request.start = options.start;
    request.allow_unknown = options.allow_unknown;
    request.body_radius = options.body_radius;
    request.danger_cost = options.danger_cost;
    auto reply = worker_->ask(request, timeout);
    if (!reply) return reply.error();
    auto& [id, revision, path] = std::get<wire::PlanReply>(*reply);
    if (!path) return path.error();
    return from_wire(std::move(*path), revision);
}

Result<ExplorationGoal> Client::next_goal(milliseconds timeout) {
    auto reply = worker_->ask(wire::GoalRequest{}, timeout);
    if (!reply) return reply.error();
    auto& goal = std::get<wire::GoalReply>(*reply).result;
    if (!goal) return goal.error();
    ExplorationGoal next;
    next.given_up = goal->given_up;
    next.in_danger = goal->in_danger;
    if (goal->exploration == wire::Exploration::kTakenByOthers) next.outcome = ExplorationGoal::Outcome::kTakenByOthers;
    if (goal->exploration != wire::Exploration::kGoal) return next;
    next.outcome = ExplorationGoal::Outcome::kGoal;
    next.path = std::move(goal->path->points); // always present with a goal
    next.target = *goal->target;
    return next;
}

Result<Coverage> Client::coverage(milliseconds timeout, const CoverageOptions& options) {
    wire::CoverageRequest request;
    request.start = options.start;
    request.body_radius = options.body_radius;
    request.spacing = options.spacing;
    request.region = options.region;
    auto reply = worker_->ask(std::move(request), timeout);
    if (!reply) return reply.error();
    auto& [id, revision, found] = std::get<wire::CoverageReply>(*reply);
    if (!found) return found.error();
    Coverage coverage{
        from_wire(std::move(found->path), revision), found->free_area, found->covered_area, {}, found->cell_size};
    for (const auto& run : found->unreachable) coverage.unreachable.push_back({run.j, run.i, run.count});
    return coverage;
}

Result<Location> Client::locate(const std::shared_ptr<const Sensor>& sensor, std::span<const Scan> scans,
                                milliseconds timeout, const LocateOptions& options) {
    auto seen = seen_from(sensor, scans);
    if (!seen) return seen.error();
    wire::LocateRequest request;
    request.points = seen->points();
    request.from = seen->from();
    if (options.near) request.near = wire::Near{options.near->point, options.near->radius};
    auto reply = worker_->ask(std::move(request), timeout);
    if (!reply) return reply.error();
    const auto& found = std::get<wire::LocateReply>(*reply).result;
    if (!found) return found.error();
    return location_of(*found);
}

std::optional<Location> Client::transform() const { return worker_->transform(); }

ClientStatus Client::status() const { return worker_->status(); }

} // namespace scanloom::robot
