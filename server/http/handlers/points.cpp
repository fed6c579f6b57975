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
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

constexpr std::size_t kPointsMax = 1'000'000; // of all captures; 150 MiB while they are fused
constexpr double kThreshold = 0.05;           // metres
constexpr double kThresholdMax = 1.0;

/// Which captures, and what becomes of them.
struct Asked {
    Revision since = 0;
    Revision until = 0;
    std::optional<RobotIndex> robot;
    double threshold = kThreshold;

    [[nodiscard]] bool wants(const landmarks::RobotCapture& one) const {
        return one.capture.last > since && one.capture.last <= until && (!robot || one.robot == *robot);
    }
};

Result<Revision> until_parameter(const Query& query, Revision newest) {
    const auto text = query.find("until");
    if (!text) return newest;
    if (const auto revision = parse_integer<Revision>(*text)) return std::min(*revision, newest);
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

Result<Asked> asked_for(const mapping::Snapshot& snapshot, const Query& query) {
    const auto since = since_parameter(query);
    if (!since) return since.error();
    const auto until = until_parameter(query, snapshot.revision);
    if (!until) return until.error();
    const auto threshold = threshold_parameter(query);
    if (!threshold) return threshold.error();
    Asked asked{since_in(snapshot, *since), *until, std::nullopt, *threshold};
    if (const auto name = query.find("robot")) {
        const auto robot = guide::find_robot(snapshot, *name);
        if (!robot) return prefixed(fmt::format("robot is {}: ", in_quotes(*name)), robot.error());
        asked.robot = *robot;
    }
    return asked;
}

Error too_many(Revision since, Revision until) {
    return {Errc::kTooLarge, fmt::format("these captures have more than {} points; ask for a part of them, such as "
                                         "since={}&until={}, or for one robot's",
                                         kPointsMax, since, until)};
}

Result<std::vector<landmarks::RobotCapture>> captures_of(store::ScanLog& log, store::SessionId session,
                                                         const Asked& asked, const session::SessionRegistry& sessions) {
    std::vector<landmarks::RobotCapture> captures;
    std::size_t points = 0;
    Revision fits = asked.since; // the captures up to here do
    const auto take = [&](const landmarks::RobotCapture& one) -> Result<> {
        if (!asked.wants(one)) return {};
        points += one.capture.points.size();
        if (points > kPointsMax) return too_many(asked.since, fits);
        fits = one.capture.last;
        captures.push_back(one);
        return {};
    };
    landmarks::SessionCaptures cut;
    const auto read = session::read_captures(log, session, cut, asked.until, take, [&](Revision) -> Result<> {
        if (!sessions.is_draining()) return {};
        return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
    });
    if (!read) return read.error();
    for (const auto& open : cut.open()) {
        if (auto taken = take(open); !taken) return taken.error();
    }
    return captures;
}

} // namespace

Result<Response> get_points(session::SessionRegistry& sessions, store::ScanLog& log, const AnswerSlots& slots,
                            PointFile file, const Call& call) {
    if (auto known = call.query.check_only({"since", "until", "robot", "threshold"}); !known) return known.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    const auto snapshot = (*session)->snapshot();
    const auto asked = asked_for(*snapshot, call.query);
    if (!asked) return asked.error();
    const auto captures = captures_of(log, (*session)->info().id, *asked, sessions);
    if (!captures) return captures.error();
    std::size_t points = 0;
    for (const auto& one : *captures) points += one.capture.points.size();
    auto slot = slots.take(points * exchange::kPointTextBytes);
    if (!slot) return slot.error();
    const auto cloud = landmarks::fuse_captures(*captures, asked->threshold);
    if (!cloud) return cloud.error();
    if (file == PointFile::kPly) return ok_text("model/ply", std::move(*slot), exchange::points_ply(*cloud));
    std::vector<std::string> names;
    for (const auto& robot : snapshot->robots) names.push_back(robot.name);
    return ok_text("text/csv", std::move(*slot), exchange::points_csv(*cloud, names));
}

} // namespace scanloom::http
