#include "server/http/handlers/handlers.hpp"

#include "common/json/json_text.hpp"
#include "server/http/content_coding.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/json_read.hpp"
#include "server/http/openapi.hpp"
#include "server/http/problem.hpp"
#include "server/metrics/metrics.hpp"
#include "server/metrics/process.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

/// Damaged and failed sessions do not affect readiness, because the other sessions are available.
boost::json::object readiness(const Services& services, const auth::TokenRef& seen_by) {
    const auto is_seen = [&](std::string_view session) { return seen_by && is_for(*seen_by, session); };
    boost::json::array damaged;
    auto found = services.sessions.damaged();
    found.merge(services.check.damaged());
    for (const auto& [name, reason] : found) {
        if (is_seen(name)) damaged.push_back(damaged_json(name, reason));
    }
    boost::json::array failed;
    for (const auto& session : services.sessions.list()) {
        if (!is_seen(session->info().name)) continue;
        if (const auto reason = session->failure()) failed.push_back(failed_json(session->info().name, *reason));
    }
    boost::json::value host;
    if (!services.robots.host.empty()) host = boost::json::string(services.robots.host);
    boost::json::array warnings;
    if (const auto warning = services.log.stats().warning) warnings.emplace_back(*warning);
    return {{"status", "ready"},
            {"robots", boost::json::object{{"host", std::move(host)}, {"port", services.robots.port}}},
            {"damaged", std::move(damaged)},
            {"failed", std::move(failed)},
            {"warnings", std::move(warnings)}};
}

} // namespace

Result<Response> get_livez(Context& /*context*/) {
    return ok("text/plain; charset=utf-8", Body("ok\n")).set("Cache-Control", kNotKept);
}

Result<Response> get_readyz(Context& context) {
    boost::json::array reasons;
    const Services& services = context.services;
    if (!services.recovered) reasons.emplace_back("the sessions are still being recovered from the store");
    if (services.sessions.is_draining()) reasons.emplace_back("the server is shutting down");
    const auto store = services.log.stats();
    if (store.last_error) reasons.emplace_back("the store failed: " + *store.last_error);
    if (store.no_room) reasons.emplace_back(*store.no_room);
    if (reasons.empty()) return ok(readiness(services, context.token));
    return problem(Status::service_unavailable, "the server is not ready", "/readyz", {{"reasons", reasons}});
}

namespace {

using Families = std::vector<prometheus::MetricFamily>;
using metrics::counter_now;
using metrics::gauge_now;

Families store_families(const store::ScanLog& log) {
    const auto stats = log.stats();
    return {
        gauge_now("scanloom_store_bytes", "Bytes of the store on disk.", log.bytes_on_disk()),
        gauge_now("scanloom_store_queued_bytes", "Bytes that wait to be written.", stats.queued_bytes),
        gauge_now("scanloom_store_failed", "1 if the store accepts no more changes.", stats.last_error ? 1.0 : 0.0),
        gauge_now("scanloom_store_full", "1 if the disk has no room for more scans.", stats.no_room ? 1.0 : 0.0),
        gauge_now("scanloom_store_damaged",
                  "1 if the store no longer merges its tables because one is damaged. Damage that is found while "
                  "sessions are read counts in scanloom_sessions_damaged.",
                  stats.damage ? 1.0 : 0.0),
        counter_now("scanloom_store_appends_total", "Appends that became durable.", stats.appends),
        counter_now("scanloom_store_entries_total", "Log entries that became durable.", stats.entries),
        counter_now("scanloom_store_synced_writes_total", "Group commits, one fsync each.", stats.synced_writes),
        counter_now("scanloom_store_torn_bytes_dropped_total", "Bytes of a write that the last crash cut short.",
                    stats.torn_bytes_dropped),
    };
}

double bytes_of(std::int64_t pages) { return static_cast<double>(pages) * static_cast<double>(mapping::kPageBytes); }

std::size_t count_lost(const mapping::Snapshot& maps) {
    return static_cast<std::size_t>(std::ranges::count_if(maps.robots, [](const mapping::RobotState& robot) {
        return robot.localization.state == LocalizationState::kLost;
    }));
}

/// Returns what is known about loops, and how large the corrections were.
Families loop_families(const sessions::LoopCounters& loops) {
    prometheus::MetricFamily refused{
        "scanloom_loops_refused_total",
        "Matches and stretch tests that gave no loop: what is seen disagrees with the map, "
        "does not determine the position, or several places fit.",
        prometheus::MetricType::Counter,
        {}};
    const std::pair<const char*, const std::atomic<std::uint64_t>&> reasons[] = {
        {"disagrees", loops.disagreeing}, {"undetermined", loops.undetermined}, {"stretch", loops.stretches_refused}};
    for (const auto& [reason, count] : reasons) {
        prometheus::ClientMetric metric;
        metric.label = {{"reason", reason}};
        metric.counter.value = static_cast<double>(count.load());
        refused.metric.push_back(std::move(metric));
    }
    prometheus::ClientMetric jumps;
    auto& histogram = jumps.histogram;
    for (std::size_t n = 0; n < loops.jumps.size(); ++n) {
        histogram.sample_count += loops.jumps[n].load();
        const bool has_bound = n < loops.kJumpBounds.size();
        histogram.bucket.push_back(
            {histogram.sample_count, has_bound ? loops.kJumpBounds[n] : std::numeric_limits<double>::infinity()});
    }
    histogram.sample_sum = loops.jump_sum.load();
    return {counter_now("scanloom_loop_matches_total", "Matches of keyframes with earlier parts of the map.",
                        loops.matches.load()),
            std::move(refused),
            {"scanloom_loop_jump_metres",
             "Corrections of a keyframe's position by accepted loops, in metres.",
             prometheus::MetricType::Histogram,
             {std::move(jumps)}}};
}

Families session_families(const sessions::SessionRegistry& sessions, const sessions::BackgroundCheck& check) {
    const auto& counters = sessions.counters();
    const auto served = sessions.list();
    std::size_t backlog = 0;
    std::size_t moving = 0;
    std::size_t lost = 0;
    for (const auto& session : served) {
        lost += count_lost(*session->snapshot());
        backlog += session->backlog_size();
        moving += session->moving_scans();
    }
    const auto failed =
        std::ranges::count_if(served, [](const auto& session) { return session->failure().has_value(); });
    const auto nodes = sessions.nodes();
    const auto alive = std::ranges::count_if(nodes, &store::Node::is_alive);
    return {
        gauge_now("scanloom_nodes_alive", "Servers that share the database and are alive; 0 with a directory.", alive),
        gauge_now("scanloom_nodes_dead", "Servers that have died within a day and not returned.",
                  std::ssize(nodes) - alive),
        gauge_now("scanloom_sessions", "Sessions that are served, by all servers that share the database.",
                  sessions.all().size()),
        gauge_now("scanloom_sessions_loaded", "Sessions whose maps are in memory.", served.size()),
        gauge_now("scanloom_map_memory_bytes", "Approximate memory of these maps.", bytes_of(sessions.pages().used())),
        gauge_now("scanloom_map_memory_limit_bytes", "Limit of this memory.", bytes_of(sessions.pages().total())),
        gauge_now("scanloom_sessions_failed", "Sessions that accept no scans until they are reloaded from the store.",
                  failed),
        gauge_now("scanloom_sessions_damaged", "Sessions that could not be recovered, or were found damaged since.",
                  sessions.damaged().size() + check.damaged().size()),
        counter_now("scanloom_sessions_checked_total", "Sessions left in the store at the start that were read since.",
                    check.checked()),
        gauge_now("scanloom_backlog_entries", "Log entries of all sessions that wait to be appended.", backlog),
        counter_now("scanloom_scans_applied_total", "Scans that are durable and in their map.",
                    counters.scans_applied.load()),
        counter_now("scanloom_scans_jumped_total", "Scans that are durable and that max_jump left out of their map.",
                    counters.scans_jumped.load()),
        counter_now("scanloom_scans_unplaced_total", "Scans that are durable and not in their map: they fit no place.",
                    counters.scans_unplaced.load()),
        counter_now("scanloom_scans_duplicates_total", "Scans sent again after a reconnect and dropped.",
                    counters.scans_duplicates.load()),
        counter_now("scanloom_scans_dropped_total",
                    "Scans that were refused, or that arrived after their link was replaced; never acknowledged.",
                    counters.scans_dropped.load()),
        counter_now("scanloom_loops_accepted_total", "Edges to parts of the map that were made earlier.",
                    counters.loops_accepted.load()),
        counter_now("scanloom_maps_corrected_total",
                    "Times that the map of a session followed corrected poses of earlier scans.",
                    counters.maps_corrected.load()),
        gauge_now("scanloom_robots_lost",
                  "Robots of loaded sessions whose newest scans fit no place; those that have left count, too.", lost),
        gauge_now("scanloom_moving_scans", "Scans that the maps do not show at their corrected poses yet.", moving),
    };
}

Families tile_families(const tiles::TileCache::Stats& stats) {
    return {
        counter_now("scanloom_tile_cache_hits_total", "Requested tiles that were in the cache.", stats.hits),
        counter_now("scanloom_tile_cache_misses_total", "Requested tiles that were not in the cache.", stats.misses),
        gauge_now("scanloom_tile_cache_bytes", "Bytes of the tiles in the cache.", stats.bytes),
        gauge_now("scanloom_tile_cache_tiles", "Tiles in the cache.", stats.tiles),
    };
}

void append(Families& to, Families from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

} // namespace

Result<Response> get_metrics(Context& context) {
    const Services& services = context.services;
    Families families = services.metrics.collect();
    append(families, session_families(services.sessions, services.check));
    append(families, loop_families(services.sessions.counters().loop_search));
    append(families, {gauge_now("scanloom_weave_memory_bytes", "Upper bound of the memory of the maps of replay jobs.",
                                bytes_of(services.weaves.chunks()))});
    append(families, store_families(services.log));
    append(families, tile_families(services.tiles.stats()));
    append(families, metrics::process_families());
    return ok("text/plain; version=0.0.4; charset=utf-8", Body(metrics::to_text(families)))
        .set("Cache-Control", kNotKept);
}

Result<Response> get_openapi(Context& /*context*/) {
    static const std::string kText = json_text(openapi()) + '\n';
    static const auto kCompressed = gzip_of(kJson, kText);
    auto response = ok(kJson, Body(kText));
    response.gzip = kCompressed;
    return std::move(response).set("Cache-Control", kNotKept);
}

Result<Response> get_viewer(Context& context) {
    return serve_web_file(context.services.web, "index.html", context.request.if_none_match, context.request.host,
                          context.request.is_secure);
}

Result<Response> get_viewer_asset(Context& context) {
    return serve_web_file(context.services.web, "assets/" + context.arguments["file"], context.request.if_none_match,
                          context.request.host, context.request.is_secure);
}

namespace {

Error none_kept() {
    return {Errc::kNotFound, "this server keeps no backups; start it with --backups DIR, a directory on another disk"};
}

boost::json::object backup_json(const store::Backup& backup) {
    return {{"id", backup.id}, {"time", backup.time}, {"bytes", backup.bytes}, {"sessions", backup.sessions}};
}

} // namespace

Result<Response> list_nodes(Context& context) {
    boost::json::array listed;
    for (const auto& [info, silent, is_alive, is_dead, is_self, sessions] : context.services.sessions.nodes()) {
        listed.push_back(boost::json::object{{"name", info->name},
                                             {"alive", is_alive},
                                             {"self", is_self},
                                             {"silent", std::chrono::duration<double>(silent).count()},
                                             {"sessions", sessions},
                                             {"robots", info->robots},
                                             {"http", info->http},
                                             {"version", info->build}});
    }
    return ok(boost::json::object{{"nodes", std::move(listed)}});
}

Result<Response> drain_node(Context& context) {
    const auto body = parse_json_object(context.request.body, {});
    if (!body) return body.error();
    context.services.drain();
    auto response = ok(boost::json::object{{"draining", true}});
    response.status = Status::accepted;
    return response;
}

Result<Response> list_backups(Context& context) {
    auto* const backups = context.services.backups;
    if (backups == nullptr) return none_kept();
    const auto there = backups->list();
    if (!there) return there.error();
    boost::json::array listed;
    for (const auto& backup : *there) listed.push_back(backup_json(backup));
    return ok(boost::json::object{{"backups", std::move(listed)}, {"kept", backups->kept()}});
}

Result<Response> make_backup(Context& context) {
    auto* const backups = context.services.backups;
    if (backups == nullptr) return none_kept();
    const auto made = backups->make(context.services.log);
    if (!made) return made.error();
    return created(backup_json(*made));
}

} // namespace scanloom::http
