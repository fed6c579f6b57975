#include "load/core/live_view.hpp"

#include "load/core/figure_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace scanloom::load {
namespace {

/// Figures for the time between two moments.
struct Lately {
    double seconds = 0.0;
    double sent = 0.0; ///< scans per second
    double acknowledged = 0.0;
    LatencyHistogram ack;
    LatencyHistogram own_delay;
    double own_cores = 0.0;
    std::optional<ServerUsed> server;
    double events = 0.0; ///< per second
    double tiles = 0.0;
};

Lately lately(bool is_paced, const Moment& before, const Moment& now) {
    Lately shown;
    shown.seconds = std::max(in_seconds(now.at - before.at), 1e-6);
    const auto rate = [&](std::uint64_t earlier, std::uint64_t later) {
        return static_cast<double>(later - earlier) / shown.seconds;
    };
    shown.sent = rate(before.fleet.scans_sent, now.fleet.scans_sent);
    shown.acknowledged = rate(before.fleet.scans_acknowledged, now.fleet.scans_acknowledged);
    shown.ack = is_paced ? now.fleet.from_intended.since(before.fleet.from_intended)
                         : now.fleet.from_sending.since(before.fleet.from_sending);
    shown.own_delay = now.fleet.own_delay.since(before.fleet.own_delay);
    shown.own_cores = (now.own.cpu_seconds - before.own.cpu_seconds) / shown.seconds;
    shown.server = used_between(before.server, now.server);
    shown.events = rate(before.audience.events, now.audience.events);
    shown.tiles = rate(before.audience.tile_requests, now.audience.tile_requests);
    return shown;
}

std::string ack_text(const LatencyHistogram& ack) {
    if (ack.count() == 0) return "none";
    return fmt::format("p50 {}  p99 {}  max {} ms", as_milliseconds(ack.percentile(50)),
                       as_milliseconds(ack.percentile(99)), as_milliseconds(ack.max()));
}

std::string server_text(const Lately& shown) {
    if (!shown.server) return "does not report its use";
    const auto& cpu_seconds = shown.server->cpu_seconds;
    return fmt::format("{}, {}", cpu_seconds ? fmt::format("{:.2f} cores", *cpu_seconds / shown.seconds) : "restarted",
                       as_bytes(shown.server->resident_bytes));
}

std::string time_text(const RunSettings& settings, Micros begun, const Moment& now) {
    const double seconds = std::max(in_seconds(now.at - begun), 0.0);
    if (seconds <= settings.duration + 0.5) return fmt::format("{:.0f} of {:g} s", seconds, settings.duration);
    return fmt::format("{:.0f} s after the last scan", seconds - settings.duration);
}

std::uint64_t under_way(const FleetFigures& fleet) {
    return std::max(fleet.scans_due, fleet.scans_sent) - fleet.scans_acknowledged;
}

std::uint64_t without_link(const RunSettings& settings, const FleetFigures& fleet) {
    // A robot that has just finished is briefly counted in both.
    const std::uint64_t accounted = std::uint64_t{fleet.linked} + fleet.finished;
    return settings.robots - std::min<std::uint64_t>(accounted, settings.robots);
}

std::uint64_t faults_of(const FleetFigures& fleet) {
    return std::accumulate(fleet.faults.begin(), fleet.faults.end(), std::uint64_t{0});
}

} // namespace

std::string live_line(const RunSettings& settings, Micros begun, const Moment& before, const Moment& now) {
    const Lately shown = lately(settings.rate > 0.0, before, now);
    auto text = fmt::format("{}: {}/s sent, {}/s acknowledged, {} in flight; ack {}; generator {:.2f} cores, server {}",
                            time_text(settings, begun, now), whole(shown.sent), whole(shown.acknowledged),
                            grouped(under_way(now.fleet)), ack_text(shown.ack), shown.own_cores, server_text(shown));
    if (const auto alone = without_link(settings, now.fleet); alone > 0) {
        text += fmt::format("; {} of {} robots have no link", grouped(alone), grouped(settings.robots));
    }
    if (settings.viewers > 0) text += fmt::format("; {:.0f} events/s", shown.events);
    if (settings.tile_readers > 0) text += fmt::format("; {:.0f} tiles/s", shown.tiles);
    return text;
}

std::vector<std::string> live_table(const RunSettings& settings, Micros begun, const Moment& before,
                                    const Moment& now) {
    const Lately shown = lately(settings.rate > 0.0, before, now);
    const FleetFigures& fleet = now.fleet;
    const auto row = [](std::string_view label, const std::string& text) {
        return fmt::format("{:<14}{}", label, text);
    };
    std::vector<std::string> rows{
        row("time", time_text(settings, begun, now)),
        row("robots",
            fmt::format("{}: {} connected, {} done, {} without a link", grouped(settings.robots), grouped(fleet.linked),
                        grouped(fleet.finished), grouped(without_link(settings, fleet)))),
        row("sent", fmt::format("{:>10}/s {:>14} in total", whole(shown.sent), grouped(fleet.scans_sent))),
        row("acknowledged",
            fmt::format("{:>10}/s {:>14} in total", whole(shown.acknowledged), grouped(fleet.scans_acknowledged))),
        row("in flight", fmt::format("{:>10}", grouped(under_way(fleet)))),
        row("ack", ack_text(shown.ack)),
        row("generator",
            fmt::format("{:.2f} cores{}", shown.own_cores,
                        shown.own_delay.count() == 0
                            ? ""
                            : fmt::format(", delay {} ms (p99)", as_milliseconds(shown.own_delay.percentile(99))))),
        row("server", server_text(shown))};
    if (settings.viewers > 0) {
        rows.push_back(row("viewers", fmt::format("{} watch, {:.0f} events/s", now.audience.watching, shown.events)));
    }
    if (settings.tile_readers > 0) rows.push_back(row("tiles", fmt::format("{:.0f}/s", shown.tiles)));
    if (!settings.faults_text.empty()) {
        rows.push_back(row("faults", fmt::format("{}, {} reconnects", grouped(faults_of(fleet)),
                                                 grouped(fleet.links - fleet.greeted))));
    }
    return rows;
}

} // namespace scanloom::load
