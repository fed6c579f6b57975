#include "load/core/report.hpp"

#include "common/json/json_text.hpp"
#include "load/core/words.hpp"

#include <boost/json/object.hpp>

#include <algorithm>
#include <cmath>

namespace scanloom::load {

namespace json = boost::json;

namespace {

double in_milliseconds(Micros time) { return static_cast<double>(time) / static_cast<double>(kMillisecond); }

/// Six digits exceed the accuracy of all these values.
double rounded(double value) { return std::round(value * 1e6) / 1e6; }

json::object latency_json(const LatencyHistogram& latency) {
    return {{"count", latency.count()},
            {"p50_ms", in_milliseconds(latency.percentile(50))},
            {"p90_ms", in_milliseconds(latency.percentile(90))},
            {"p99_ms", in_milliseconds(latency.percentile(99))},
            {"p99_9_ms", in_milliseconds(latency.percentile(99.9))},
            {"max_ms", in_milliseconds(latency.max())}};
}

json::object settings_json(const RunSettings& settings) {
    json::object object{{"robots", settings.robots},
                        {"sessions", settings.sessions},
                        {"rate", settings.rate},
                        {"batch", settings.batch},
                        {"duration", settings.duration},
                        {"world", settings.world},
                        {"laser", settings.laser},
                        {"noise", settings.noise},
                        {"beams", settings.beams},
                        {"seed", settings.seed},
                        {"threads", settings.threads},
                        {"viewers", settings.viewers},
                        {"tile_readers", settings.tile_readers},
                        {"tile_rate", settings.tile_rate},
                        {"faults", settings.faults_text}};
    object["cell_size"] = settings.cell_size ? json::value(*settings.cell_size) : json::value();
    return object;
}

json::object scans_json(const RunReport& report) {
    const FleetFigures& fleet = report.fleet;
    return {
        {"due", fleet.scans_due},
        {"sent", fleet.scans_sent},
        {"sent_again", fleet.scans_resent},
        {"acknowledged", fleet.scans_acknowledged},
        {"acknowledged_per_second", rounded(per_second(static_cast<double>(fleet.scans_acknowledged), report.seconds))},
        {"lost", fleet.scans_lost},
        {"frames", fleet.frames_out}};
}

json::object links_json(const FleetFigures& fleet) {
    json::object faults;
    for (std::size_t i = 0; i < kFaultKinds; ++i) faults[kFaultNames[i]] = fleet.faults[i];
    return {
        {"faults", std::move(faults)}, {"reconnects", fleet.links - fleet.greeted}, {"robots_failed", fleet.failed}};
}

json::object audience_json(const AudienceFigures& seen) {
    return {{"viewers_let_in", seen.viewers_let_in},
            {"viewers_refused", seen.viewers_refused},
            {"events", seen.events},
            {"event_bytes", seen.event_bytes},
            {"viewers_cut_off", seen.viewer_ends},
            {"tile_requests", seen.tile_requests},
            {"tiles_unchanged", seen.tiles_unchanged},
            {"tiles_failed", seen.tiles_failed},
            {"tile_bytes", seen.tile_bytes},
            {"tile_latency", latency_json(seen.tile_latency)},
            {"trouble", seen.trouble}};
}

json::object use_json(const ProcessUse& use, double seconds) {
    return {{"cpu_seconds", rounded(use.cpu_seconds)},
            {"cores", rounded(per_second(use.cpu_seconds, seconds))},
            {"resident_bytes", use.resident_bytes}};
}

json::object server_json(const RunReport& report) {
    if (!report.server) return {};
    const auto& cpu_seconds = report.server->cpu_seconds;
    if (!cpu_seconds) return {{"resident_bytes", report.server->resident_bytes}};
    auto server = use_json({*cpu_seconds, report.server->resident_bytes}, report.watched_seconds);
    const auto scans = static_cast<double>(std::max<std::uint64_t>(report.fleet.scans_acknowledged, 1));
    server["cpu_us_per_scan"] = rounded(*cpu_seconds / scans * 1e6);
    return server;
}

json::object verdict_json(const RunReport& report) {
    json::array against;
    for (const auto& sentence : report.evidence.contradictions) against.emplace_back(sentence);
    for (const auto& sentence : report.evidence.failures) against.emplace_back(sentence);
    return {{"nothing_lost", report.verdict.is_good},
            {"sentence", report.verdict.sentence},
            {"scans_in_sessions", report.evidence.scans_in_sessions},
            {"digests_equal", report.evidence.digests_equal},
            {"against", std::move(against)}};
}

} // namespace

std::string to_json(const RunReport& report) {
    json::object all{{"settings", settings_json(report.settings)},
                     {"seconds", rounded(report.seconds)},
                     {"scans", scans_json(report)},
                     {"bytes_out", report.fleet.bytes_out},
                     {"bytes_in", report.fleet.bytes_in},
                     {"ack_from_sending", latency_json(report.fleet.from_sending)},
                     {"generator", use_json(report.own, report.watched_seconds)},
                     {"server", server_json(report)},
                     {"audience", audience_json(report.audience)},
                     {"links", links_json(report.fleet)},
                     {"verdict", verdict_json(report)}};
    if (report.settings.rate > 0.0) { // otherwise scans have no intended sending times
        all["ack_from_intended"] = latency_json(report.fleet.from_intended);
        all["sending_from_intended"] = latency_json(report.fleet.waiting_to_send);
        all["own_delay"] = latency_json(report.fleet.own_delay);
    }
    return json_text(all) + "\n";
}

} // namespace scanloom::load
