#include "load/core/report.hpp"

#include "load/core/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::load {
namespace {

std::string line(std::string_view label, std::string_view text) { return fmt::format("{:<11}{}\n", label, text); }

double per_second(std::uint64_t count, double seconds) { return load::per_second(static_cast<double>(count), seconds); }

std::string counted(std::uint64_t count, std::string_view one) {
    return fmt::format("{} {}{}", grouped(count), one, count == 1 ? "" : "s");
}

std::string title(const RunSettings& settings) {
    const auto pace = settings.rate > 0.0 ? fmt::format("at {:g} scans/s", settings.rate) : "as fast as permitted";
    const auto cells = settings.cell_size ? fmt::format(", cells of {:g} m", *settings.cell_size) : "";
    const auto batch = settings.batch > 1 ? fmt::format(", {} scans a frame", settings.batch) : "";
    return fmt::format("{} {} for {:g} s into {}: world {}, laser {} of {} beams, noise {}{}{}, seed {}\n\n",
                       counted(settings.robots, "robot"), pace, settings.duration,
                       counted(settings.sessions, "session"), settings.world, settings.laser, settings.beams,
                       settings.noise, cells, batch, settings.seed);
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
    auto text = fmt::format("{:.2f} cores, memory {}", load::per_second(report.own.cpu_seconds, report.watched_seconds),
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
                                      load::per_second(*cpu_seconds, report.watched_seconds), each * 1e6, memory));
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

} // namespace scanloom::load
