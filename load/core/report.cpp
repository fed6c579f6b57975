#include "load/core/report.hpp"

#include "common/json/json_text.hpp"
#include "load/core/figure_text.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::load {

namespace json = boost::json;

// For people ----------------------------------------------------------------------------------------------------------

namespace {

std::string line(std::string_view label, std::string_view text) { return fmt::format("{:<11}{}\n", label, text); }

std::string counted(std::uint64_t count, std::string_view one) {
    return fmt::format("{} {}{}", grouped(count), one, count == 1 ? "" : "s");
}

std::string title(const RunSettings& settings) {
    const auto pace = settings.rate > 0.0 ? fmt::format("at {:g} scans/s", settings.rate) : "as fast as permitted";
    const auto cells = settings.cell_size ? fmt::format(", cells of {:g} m", *settings.cell_size) : "";
    const auto batch = settings.batch > 1 ? fmt::format(", {} scans a frame", settings.batch) : "";
    const auto poses = settings.poses == Poses::kMap ? "" : fmt::format(", poses {}", name_of(settings.poses));
    return fmt::format("{} {} for {:g} s into {}: world {}, laser {} of {} beams, noise {}{}{}{}, seed {}\n\n",
                       counted(settings.robots, "robot"), pace, settings.duration,
                       counted(settings.sessions, "session"), settings.world, settings.laser, settings.beams,
                       settings.noise, poses, cells, batch, settings.seed);
}

std::string scans(const RunReport& report) {
    const FleetFigures& fleet = report.fleet;
    const double intended = report.settings.rate * report.settings.robots;
    return line("scans", fmt::format("{} sent, {} acknowledged: {}/s{}", grouped(fleet.scans_sent),
                                     grouped(fleet.scans_acknowledged),
                                     whole(per_second(fleet.scans_acknowledged, report.seconds)),
                                     intended > 0.0 ? fmt::format(" of {}/s intended", whole(intended)) : ""));
}

std::string bytes(const RunReport& report) {
    const auto each_way = [&](std::uint64_t count, std::string_view where) {
        const auto total = static_cast<double>(count);
        return fmt::format("{} {} ({}/s)", as_bytes(total), where, as_bytes(per_second(count, report.seconds)));
    };
    return line("bytes",
                each_way(report.fleet.bytes_out, "to the server") + ", " + each_way(report.fleet.bytes_in, "back"));
}

std::string percentiles(std::string_view label, const LatencyHistogram& latency) {
    return fmt::format("  {:<24}{:>9}{:>9}{:>9}{:>9}{:>9}\n", label, as_milliseconds(latency.percentile(50)),
                       as_milliseconds(latency.percentile(90)), as_milliseconds(latency.percentile(99)),
                       as_milliseconds(latency.percentile(99.9)), as_milliseconds(latency.max()));
}

std::string latencies(const RunReport& report) {
    auto text =
        fmt::format("{:<26}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "milliseconds until", "p50", "p90", "p99", "p99.9", "max");
    const bool is_paced = report.settings.rate > 0.0;
    if (is_paced) text += percentiles("ack, from intended time", report.fleet.from_intended);
    text += percentiles("ack, from sending", report.fleet.from_sending);
    if (is_paced) text += percentiles("sending, from intended", report.fleet.waiting_to_send);
    if (report.audience.tile_requests > 0) text += percentiles("tile received", report.audience.tile_latency);
    return text;
}

std::string generator(const RunReport& report) {
    auto text = fmt::format("{:.2f} cores, memory {}", per_second(report.own.cpu_seconds, report.watched_seconds),
                            as_bytes(report.own.resident_bytes));
    if (report.settings.rate > 0.0) {
        const LatencyHistogram& delay = report.fleet.own_delay;
        text += fmt::format("; delay behind its schedule {} ms (p99), at most {} ms: ",
                            as_milliseconds(delay.percentile(99)), as_milliseconds(delay.max()));
        text += delay.percentile(99) <= kOwnDelayFine
                    ? "on schedule"
                    : "IT FELL BEHIND, and the latencies include this delay;\n"
                      "           give it more --threads, another machine, or less to do";
    }
    return line("generator", text);
}

std::string server(const RunReport& report) {
    if (!report.server) return line("server", "did not report its use");
    const auto memory = as_bytes(report.server->resident_bytes);
    const auto& cpu_seconds = report.server->cpu_seconds;
    if (!cpu_seconds) {
        return line("server",
                    fmt::format("was restarted during the run, so its CPU time is unknown; memory {}", memory));
    }
    const double each = *cpu_seconds / std::fmax(1.0, static_cast<double>(report.fleet.scans_acknowledged));
    return line("server", fmt::format("{:.2f} cores, {:.0f} us of CPU per acknowledged scan, memory {}",
                                      per_second(*cpu_seconds, report.watched_seconds), each * 1e6, memory));
}

std::string viewers(const RunReport& report) {
    if (report.settings.viewers == 0) return {};
    const AudienceFigures& seen = report.audience;
    const std::uint32_t wanted = report.settings.viewers;
    auto text = fmt::format("{}{} watched: {} events, {:.1f}/s each, {}", seen.viewers_let_in,
                            seen.viewers_let_in < wanted ? fmt::format(" of {}", wanted) : "", grouped(seen.events),
                            per_second(seen.events, report.seconds) / std::max(seen.viewers_let_in, 1U),
                            as_bytes(static_cast<double>(seen.event_bytes)));
    if (seen.viewers_refused > 0) text += fmt::format("; {} REFUSED", grouped(seen.viewers_refused));
    const std::uint32_t came = seen.viewers_let_in + seen.viewers_refused;
    if (came < wanted) text += fmt::format("; {} HAD NO CONNECTION", grouped(wanted - came));
    if (seen.viewer_ends > 0) text += fmt::format("; {} ended early", counted(seen.viewer_ends, "connection"));
    return line("viewers", text);
}

std::string tiles(const RunReport& report) {
    if (report.settings.tile_readers == 0) return {};
    const AudienceFigures& seen = report.audience;
    const auto all = static_cast<double>(std::max<std::uint64_t>(seen.tile_requests, 1));
    auto text = fmt::format("{} requested: {} tiles, {}/s, {:.0f} % of them unchanged (304), {}",
                            counted(report.settings.tile_readers, "reader"), grouped(seen.tile_requests),
                            whole(per_second(seen.tile_requests, report.seconds)),
                            100.0 * static_cast<double>(seen.tiles_unchanged) / all,
                            as_bytes(static_cast<double>(seen.tile_bytes)));
    if (seen.tiles_failed > 0) text += fmt::format("; {} FAILED", grouped(seen.tiles_failed));
    return line("tiles", text);
}

std::string trouble(const RunReport& report) {
    return report.audience.trouble.empty() ? "" : line("trouble", report.audience.trouble);
}

std::string links(const RunReport& report) {
    const FleetFigures& fleet = report.fleet;
    std::string struck;
    for (std::size_t i = 0; i < kFaultKinds; ++i) {
        if (fleet.faults[i] == 0) continue;
        struck += fmt::format("{}{} {}", struck.empty() ? "" : ", ", grouped(fleet.faults[i]), kFaultNames[i]);
    }
    const std::uint64_t reconnects = fleet.links - fleet.greeted;
    if (struck.empty() && reconnects == 0) return {};
    return line("links", fmt::format("faults on demand: {}; {}, {} sent again", struck.empty() ? "none" : struck,
                                     counted(reconnects, "reconnect"), counted(fleet.scans_resent, "scan")));
}

} // namespace

std::string to_text(const RunReport& report) {
    return title(report.settings) + scans(report) + bytes(report) + latencies(report) + generator(report) +
           server(report) + viewers(report) + tiles(report) + trouble(report) + links(report) + "\n" +
           report.verdict.sentence + "\n";
}

// For programs --------------------------------------------------------------------------------------------------------

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
                        {"poses", std::string(name_of(settings.poses))},
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
    return {{"due", fleet.scans_due},
            {"sent", fleet.scans_sent},
            {"sent_again", fleet.scans_resent},
            {"acknowledged", fleet.scans_acknowledged},
            {"acknowledged_per_second", rounded(per_second(fleet.scans_acknowledged, report.seconds))},
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
