#include "server/ingest/request_executor.hpp"

#include "server/guidance/plans.hpp"
#include "server/guidance/search_limit.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <exception>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace scanloom::ingest {
namespace {

using link::reply;

/// Joins adjacent cells of a row into runs. The cells are sorted by rows.
std::vector<wire::CellRun> runs_of(std::span<const grid::Cell> cells) {
    std::vector<wire::CellRun> runs;
    for (const grid::Cell cell : cells) {
        const bool goes_on = !runs.empty() && runs.back().j == cell.j && runs.back().i + runs.back().count == cell.i;
        if (!goes_on) runs.push_back({cell.j, cell.i, 0});
        ++runs.back().count;
    }
    return runs;
}

/// Converts a path for the wire.
/// @param runs  number of cell runs in the same reply
/// Errors: kTooLarge if the path and the runs do not fit into one frame.
Result<wire::Path> to_wire(planning::Path path, std::size_t runs = 0) {
    if (path.points.size() + runs > wire::kReplyPointsMax) {
        return Error{
            Errc::kTooLarge,
            fmt::format(
                "the path has {} points, and the area that it cannot reach {} runs of cells; at most {} together "
                "fit a reply; ask for a smaller region, or rows further apart",
                path.points.size(), runs, wire::kReplyPointsMax)};
    }
    return wire::Path{std::move(path.points), path.length_m, path.cost};
}

/// Answers requests from one snapshot and one start.
struct Search {
    const Requester& requester;
    const RequestServices& services;
    const mapping::Snapshot& maps;
    const guidance::Start& start;

    [[nodiscard]] Result<wire::Path> operator()(const wire::PlanRequest& request) const {
        auto path = guidance::plan_path(maps, start, request.goal,
                                        {request.body_radius, request.allow_unknown, request.danger_cost});
        if (!path) return path.error();
        return to_wire(std::move(*path));
    }

    [[nodiscard]] Result<wire::Goal> operator()(const wire::GoalRequest& request) const {
        planning::ExplorationOptions options;
        options.passability = guidance::passability_of({.radius = request.body_radius}, start.body_radius);
        if (request.frontier_size_min > 0) options.frontier_size_min = request.frontier_size_min;
        auto next = services.goals.next(requester.session, maps, requester.robot, start.point,
                                        guidance::GoalAssignments::Clock::now(), options);
        if (!next) return next.error();
        const auto given_up = static_cast<std::uint32_t>(next->given_up); // fits: GoalAssignments keeps fewer
        if (next->outcome == planning::Exploration::kTakenByOthers) {
            return wire::Goal{wire::Exploration::kTakenByOthers, std::nullopt, std::nullopt, given_up};
        }
        if (!next->goal) return wire::Goal{wire::Exploration::kComplete, std::nullopt, std::nullopt, given_up};
        auto path = to_wire(std::move(next->path));
        if (!path) return path.error();
        const grid::Cell cell = next->goal->target;
        return wire::Goal{wire::Exploration::kGoal, std::move(*path),
                          Point2{cell.i + 0.5, cell.j + 0.5} * maps.config.cell_size, given_up, next->goal->in_danger};
    }

    [[nodiscard]] Result<wire::Coverage> operator()(const wire::CoverageRequest& request) const {
        auto coverage = guidance::plan_coverage(maps, start, {request.body_radius, request.spacing, request.region},
                                                services.sessions);
        if (!coverage) return coverage.error();
        auto unreachable = runs_of(coverage->unreachable);
        auto path = to_wire(std::move(coverage->path), unreachable.size());
        if (!path) return path.error();
        const double cell_area = maps.config.cell_size * maps.config.cell_size;
        return wire::Coverage{std::move(*path), static_cast<double>(coverage->free_cells) * cell_area,
                              static_cast<double>(coverage->covered_cells) * cell_area, std::move(unreachable),
                              maps.config.cell_size};
    }
};

/// Returns the path that live viewers show for the robot.
std::optional<guidance::HeldPath> held_path(const Result<wire::Path>& path, Revision revision) {
    if (!path) return std::nullopt;
    return guidance::HeldPath{guidance::PathKind::kPlan, path->points, path->length, revision};
}
std::optional<guidance::HeldPath> held_path(const Result<wire::Coverage>& coverage, Revision revision) {
    if (!coverage) return std::nullopt;
    return guidance::HeldPath{guidance::PathKind::kCoverage, coverage->path.points, coverage->path.length, revision};
}

template <class Kind>
wire::Message reply_from(const Kind& request, const Requester& requester, const RequestServices& services) {
    const auto maps = requester.session->snapshot();
    const auto start = guidance::start_of(*maps, requester.robot, request.start);
    if (!start) {
        services.goals.paths().take_back(requester.session, requester.robot);
        return reply(request, maps->revision, start.error());
    }
    auto found = Search{requester, services, *maps, *start}(request);
    if constexpr (!std::is_same_v<Kind, wire::GoalRequest>) { // GoalAssignments has set the path to the goal
        services.goals.paths().set_path(requester.session, requester.robot, held_path(found, maps->revision),
                                        guidance::RobotPaths::Clock::now());
    }
    return reply(request, maps->revision, std::move(found));
}

const Error kLinkClosed{Errc::kUnreachable, "the link is closed"};

wire::Message reply_from(const wire::LocateRequest& request, const Requester& requester,
                         const RequestServices& services) {
    const auto points = landmarks::in_metres(request.points);
    std::optional<landmarks::Neighbourhood> near;
    if (request.near) near = landmarks::Neighbourhood{request.near->point, request.near->radius};
    const guidance::SearchLimit limit(services.sessions, guidance::SearchLimit::kTime,
                                      "give a point near its position");
    const auto ask = [&]() -> Result<> { return *requester.is_gone ? Result<>(kLinkClosed) : limit(); };
    const auto located = services.locator.locate(*requester.session, requester.robot,
                                                 {.points = points, .from = request.from}, near, ask);
    if (!located) return reply(request, requester.session->snapshot()->revision, located.error());
    const auto& found = located->alignment;
    return reply(request, located->revision,
                 wire::Correction{found.T_first_second, located->revision, found.inlier_ratio, found.position_sigma,
                                  found.yaw_sigma});
}

} // namespace

std::optional<Error> RequestExecutor::submit(Requester requester, link::Request request, Done done) {
    const bool locates = std::holds_alternative<wire::LocateRequest>(request);
    auto permit = (locates ? locating_permits_ : permits_).try_acquire();
    if (!permit)
        return Error{Errc::kOverloaded, "too many requests of robots are waiting at this moment; try again soon"};
    boost::asio::post(locates ? locating_ : planning_,
                      [this, requester = std::move(requester), request = std::move(request), done = std::move(done),
                       permit = std::move(permit)]() mutable {
                          std::string frame;
                          wire::encode(answer(request, requester), frame);
                          done(std::move(frame), std::move(permit));
                      });
    return std::nullopt;
}

/// Starts no search while the server shuts down, because shutdown would have to wait for it.
wire::Message RequestExecutor::answer(const link::Request& request, const Requester& requester) const {
    if (services_.sessions.is_draining())
        return link::refusal_of(request, {Errc::kShuttingDown, "the server is shutting down"});
    if (*requester.is_gone) return link::refusal_of(request, kLinkClosed);
    try {
        return std::visit([&](const auto& kind) { return reply_from(kind, requester, services_); }, request);
    } catch (const std::bad_alloc&) {
        return link::refusal_of(request,
                                {Errc::kOverloaded, "there is no memory for this search now; ask again later"});
    } catch (const std::exception& failure) {
        return link::refusal_of(request, {Errc::kInternal, fmt::format("the search failed: {}", failure.what())});
    }
}

} // namespace scanloom::ingest
