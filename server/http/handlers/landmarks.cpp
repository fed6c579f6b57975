#include "server/http/handlers/handlers.hpp"

#include "core/landmarks/cloud_fusion.hpp"
#include "core/landmarks/landmark_matching.hpp"
#include "server/exchange/point_text.hpp"
#include "server/guidance/search_limit.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/sessions/log_readers.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

constexpr std::size_t kLandmarkTextBytes = 320;

/// Selects landmarks.
struct LandmarkQuery {
    Revision since = 0;
    std::optional<tiles::Extent> bbox;
    std::uint32_t seen_min = 1;

    [[nodiscard]] bool wants(const landmarks::MapLandmark& one) const {
        const auto& at = one.landmark.position;
        const bool inside =
            !bbox || (at.x >= bbox->min_x && at.x <= bbox->max_x && at.y >= bbox->min_y && at.y <= bbox->max_y);
        return one.last > since && one.seen >= seen_min && inside;
    }
};

double rounded(double ratio) { return std::round(ratio * 1e4) / 1e4; }

boost::json::value mean(double sum, std::uint64_t count) {
    if (count == 0) return nullptr;
    return rounded(sum / static_cast<double>(count));
}

std::string feature_of(const landmarks::MapLandmark& one) {
    const auto& landmark = one.landmark;
    return feature({{"seen", one.seen},
                    {"points", landmark.points},
                    {"size", position(landmark.size)},
                    {"spread", rounded_metres(landmark.spread)},
                    {"continuity", rounded(landmark.continuity)},
                    {"first", one.first},
                    {"last", one.last}},
                   point_geometry(landmark.position), one.id);
}

} // namespace

Result<Response> get_landmarks(Context& context) {
    const auto since = since_parameter(context.query);
    if (!since) return since.error();
    const auto bbox = bbox_parameter(context.query);
    if (!bbox) return bbox.error();
    if (*bbox && ((*bbox)->min_x > (*bbox)->max_x || (*bbox)->min_y > (*bbox)->max_y)) {
        return Error{Errc::kInvalidField, "bbox is empty: min_x,min_y,max_x,max_y in metres, the smaller ones first"};
    }
    const auto seen_min =
        parameter(context.query, "seen_min", std::uint32_t{1}, integer_from<std::uint32_t>(1, UINT32_MAX),
                  "a whole number from 1 to 4294967295 is needed");
    if (!seen_min) return seen_min.error();
    const auto& session = context.session;
    const auto snapshot = session->snapshot();
    const auto applied = context.services.landmarks.up_to(session->info(), snapshot->revision, snapshot->scan_poses,
                                                          [&] { return !context.services.sessions.is_draining(); });
    if (!applied) return applied.error();
    const LandmarkQuery asked{since_in_poses(*snapshot, *since), *bbox, *seen_min};
    std::vector<const landmarks::MapLandmark*> wanted;
    for (const auto& block : applied->state.landmarks.blocks()) {
        if (block->revision <= asked.since) continue;
        for (const auto& one : block->landmarks) {
            if (asked.wants(one)) wanted.push_back(&one);
        }
    }
    auto permit = context.services.responses.take(wanted.size() * kLandmarkTextBytes);
    if (!permit) return permit.error();
    std::vector<std::string> features;
    features.reserve(wanted.size());
    for (const auto* one : wanted) features.push_back(feature_of(*one));
    const auto& sums = applied->state.sums;
    return ok_text(kGeoJson, std::move(*permit),
                   collection_document(applied->revision,
                                       {{"reset", asked.since != *since},
                                        {"captures", applied->state.captures},
                                        {"landmarks", applied->state.landmarks.size()},
                                        {"tolerance", landmarks::kTolerance},
                                        {"persistence", mean(sums.persistence, sums.persistence_pairs)},
                                        {"stability", mean(sums.stability, sums.stability_pairs)},
                                        {"continuity", mean(sums.continuity, sums.landmarks)}},
                                       features));
}

namespace {

constexpr std::size_t kFusedPointsMax = 1'000'000; // of all captures; need 100 MiB during fusion
constexpr double kThreshold = 0.05;                // metres
constexpr double kThresholdMax = 1.0;

enum class PointFile { kCsv, kPly, kPcd };

/// Selects captures and sets how they are fused.
struct CloudQuery {
    Revision since = 0;
    std::optional<Revision> until; ///< nullopt: unfinished captures, too; else they belong to a later part
    std::optional<RobotIndex> robot;
    double threshold = kThreshold;

    [[nodiscard]] bool wants(RobotIndex of, Revision ended) const { return ended > since && (!robot || of == *robot); }
};

std::optional<double> parse_threshold(std::string_view text) {
    const auto metres = parse_real(text);
    return metres && *metres >= 0.0 && *metres <= kThresholdMax ? metres : std::nullopt;
}

Result<CloudQuery> cloud_query(const mapping::Snapshot& snapshot, const Query& query) {
    const auto since = since_parameter(query);
    if (!since) return since.error();
    const auto until =
        parameter(query, "until", std::optional<Revision>(), parse_integer<Revision>, "a revision is needed");
    if (!until) return until.error();
    const auto threshold = parameter(query, "threshold", kThreshold, parse_threshold, "metres from 0 to 1 are needed");
    if (!threshold) return threshold.error();
    CloudQuery asked{*since, *until, std::nullopt, *threshold};
    if (const auto name = query.find("robot")) {
        const auto robot = robot_named(snapshot, *name);
        if (!robot) return robot.error();
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
        if (points_ > kFusedPointsMax) {
            return Error{Errc::kTooLarge, fmt::format("these captures have more than {} points; request a part of "
                                                      "them, such as since={}&until={}, or those of one robot",
                                                      kFusedPointsMax, query_.since, last_)};
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

constexpr std::chrono::seconds kPointsTime{5}; // others wait for the same thread

Result<> choose(store::ScanLog& log, const sessions::SessionInfo& session, const CloudQuery& query,
                const mapping::Snapshot& maps, const guidance::SearchLimit& limit, Chosen& chosen) {
    const Revision newest = maps.revision;
    const Revision until = std::min(newest, query.until.value_or(newest));
    // The filter is the same for every `until`, so that parts make up the whole.
    landmarks::SessionCaptures cut(sessions::scan_filter_of(session));
    auto read = sessions::read_captures(
        log, session.id, cut, until, maps.scan_poses,
        [&](const landmarks::RobotCapture& ended) { return chosen.add(ended, ended.ended); },
        [&](Revision) { return limit(); });
    if (!read || query.until) return read;
    for (const auto& open : cut.open()) {
        if (auto added = chosen.add(open, newest + 1); !added) return added;
    }
    return {};
}

Result<Response> get_points(const Context& context, PointFile file) {
    const auto& session = context.session;
    const auto snapshot = session->snapshot();
    const auto query = cloud_query(*snapshot, context.query);
    if (!query) return query.error();
    const guidance::SearchLimit limit(context.services.sessions, kPointsTime,
                                      "request fewer captures at a time (since, until, robot)");
    Chosen chosen(*query);
    const auto read = choose(context.services.log, session->info(), *query, *snapshot, limit, chosen);
    if (!read) return read.error();
    auto permit = context.services.responses.take(chosen.points() * exchange::kPointTextBytes);
    if (!permit) return permit.error();
    const auto cloud = landmarks::fuse_captures(chosen.captures(), query->threshold, limit);
    if (!cloud) return cloud.error();
    if (file == PointFile::kPly) return ok_text("model/ply", std::move(*permit), exchange::points_ply(*cloud));
    if (file == PointFile::kPcd) return ok_text("text/plain", std::move(*permit), exchange::points_pcd(*cloud));
    std::vector<std::string> names;
    for (const auto& robot : snapshot->robots) names.push_back(robot.name);
    return ok_text("text/csv", std::move(*permit), exchange::points_csv(*cloud, names));
}

} // namespace

Result<Response> get_points_csv(Context& context) { return get_points(context, PointFile::kCsv); }

Result<Response> get_points_ply(Context& context) { return get_points(context, PointFile::kPly); }

Result<Response> get_points_pcd(Context& context) { return get_points(context, PointFile::kPcd); }

} // namespace scanloom::http
