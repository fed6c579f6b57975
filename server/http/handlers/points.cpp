#include "server/http/handlers/points.hpp"

#include "server/exchange/point_text.hpp"
#include "server/guide/robots.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/session/log_captures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

constexpr std::size_t kPointsMax = 1'000'000; // of all captures; need 100 MiB during fusion
constexpr double kThreshold = 0.05;           // metres
constexpr double kThresholdMax = 1.0;

/// Selects captures and sets how they are fused.
struct CloudQuery {
    Revision since = 0;
    std::optional<Revision> until;
    std::optional<RobotIndex> robot;
    double threshold = kThreshold;

    [[nodiscard]] bool wants(RobotIndex of, Revision ended) const { return ended > since && (!robot || of == *robot); }
};

/// Without `until`, unfinished captures are included too. With it they are not, because they belong to a later part.
Result<std::optional<Revision>> until_parameter(const Query& query) {
    const auto text = query.find("until");
    if (!text) return std::optional<Revision>();
    const auto revision = parse_integer<Revision>(*text);
    if (revision) return revision;
    return Error{Errc::kInvalidField, fmt::format("until is {}; a revision is needed", in_quotes(*text))};
}

Result<double> threshold_parameter(const Query& query) {
    const auto text = query.find("threshold");
    if (!text) return kThreshold;
    const auto metres = parse_real(*text);
    if (metres && *metres >= 0.0 && *metres <= kThresholdMax) return *metres;
    return Error{Errc::kInvalidField,
                 fmt::format("threshold is {}; metres from 0 to {:g} are needed", in_quotes(*text), kThresholdMax)};
}

Result<CloudQuery> cloud_query(const mapping::Snapshot& snapshot, const Query& query) {
    const auto since = since_parameter(query);
    if (!since) return since.error();
    const auto until = until_parameter(query);
    if (!until) return until.error();
    const auto threshold = threshold_parameter(query);
    if (!threshold) return threshold.error();
    CloudQuery asked{*since, *until, std::nullopt, *threshold};
    if (const auto name = query.find("robot")) {
        const auto robot = guide::find_robot(snapshot, *name);
        if (!robot) return prefixed(fmt::format("robot is {}: ", in_quotes(*name)), robot.error());
        asked.robot = *robot;
    }
    return asked;
}

/// Collects the selected captures, up to the number of points that one response may have.
class Chosen {
public:
    explicit Chosen(const CloudQuery& query) : query_(query) {}

    /// @param ends  the log entry with which the capture ends, at the earliest
    Result<> add(const landmarks::RobotCapture& one, Revision ends) {
        if (!query_.wants(one.robot, ends)) return {};
        points_ += one.capture.points.size();
        if (points_ > kPointsMax) {
            return Error{Errc::kTooLarge,
                         fmt::format("these captures have more than {} points; ask for a part of them, "
                                     "such as since={}&until={}, or for one robot's",
                                     kPointsMax, query_.since, last_)};
        }
        last_ = one.ended;
        captures_.push_back(one);
        return {};
    }

    [[nodiscard]] const std::vector<landmarks::RobotCapture>& captures() const noexcept { return captures_; }
    [[nodiscard]] std::size_t points() const noexcept { return points_; }

private:
    const CloudQuery& query_;
    std::vector<landmarks::RobotCapture> captures_; // in the order of their ends
    std::size_t points_ = 0;
    Revision last_ = 0; // the last log entry of the captures that fit
};

/// Stops a request that takes too long, because others wait for the same thread.
class Patience {
public:
    explicit Patience(const session::SessionRegistry& sessions) : sessions_(sessions) {}

    Result<> operator()() const {
        if (sessions_.is_draining()) {
            return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
        }
        if (std::chrono::steady_clock::now() < deadline_) return {};
        return Error{Errc::kTooLarge,
                     fmt::format("this takes longer than {} s; ask for fewer captures at a time (since, until, robot)",
                                 kPatience.count())};
    }

private:
    static constexpr std::chrono::seconds kPatience{5};

    const session::SessionRegistry& sessions_;
    const std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::now() + kPatience;
};

Result<> choose(store::ScanLog& log, const session::SessionInfo& session, const CloudQuery& query, Revision newest,
                const Patience& patience, Chosen& chosen) {
    const Revision until = std::min(newest, query.until.value_or(newest));
    // The filter is the same for every `until`, so that parts make up the whole.
    landmarks::SessionCaptures cut(session::scan_filter_of(session));
    auto read = session::read_captures(
        log, session.id, cut, until,
        [&](const landmarks::RobotCapture& ended) { return chosen.add(ended, ended.ended); },
        [&](Revision) { return patience(); });
    if (!read || query.until) return read;
    for (const auto& open : cut.open()) {
        if (auto added = chosen.add(open, newest + 1); !added) return added;
    }
    return {};
}

} // namespace

Result<Response> get_points(session::SessionRegistry& sessions, store::ScanLog& log, const AnswerSlots& slots,
                            PointFile file, const Call& call) {
    if (auto known = call.query.check_only({"since", "until", "robot", "threshold"}); !known) return known.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    const auto snapshot = (*session)->snapshot();
    const auto query = cloud_query(*snapshot, call.query);
    if (!query) return query.error();
    const Patience patience(sessions);
    Chosen chosen(*query);
    const auto read = choose(log, (*session)->info(), *query, snapshot->revision, patience, chosen);
    if (!read) return read.error();
    auto slot = slots.take(chosen.points() * exchange::kPointTextBytes);
    if (!slot) return slot.error();
    const auto cloud = landmarks::fuse_captures(chosen.captures(), query->threshold, patience);
    if (!cloud) return cloud.error();
    if (file == PointFile::kPly) return ok_text("model/ply", std::move(*slot), exchange::points_ply(*cloud));
    std::vector<std::string> names;
    for (const auto& robot : snapshot->robots) names.push_back(robot.name);
    return ok_text("text/csv", std::move(*slot), exchange::points_csv(*cloud, names));
}

} // namespace scanloom::http
