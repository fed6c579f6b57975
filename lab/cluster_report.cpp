#include "lab/cluster_report.hpp"

#include "lab/cluster_simulation.hpp"
#include "lab/markdown.hpp"

#include <fmt/format.h>

namespace scanloom::lab::cluster {
namespace {

std::string_view name_of(Cause cause) {
    switch (cause) {
    case Cause::kStart: return "start";
    case Cause::kStopped: return "stopped";
    case Cause::kKilled: return "killed";
    case Cause::kSilent: return "silent";
    }
    return "";
}

std::string_view description_of(Cause cause) {
    switch (cause) {
    case Cause::kStart: return "it starts, with a new session";
    case Cause::kStopped: return "its node is stopped";
    case Cause::kKilled: return "its node's process is killed";
    case Cause::kSilent: return "its node's machine or network fails";
    }
    return "";
}

double per_second_to_cores(double scans_per_s, double us) { return scans_per_s * us / 1e6; }

/// The load of a machine, from its robots.
double node_cores_of(const Plan& plan, double robots) {
    return per_second_to_cores(robots * plan.rate_hz, plan.node_us);
}

double share_of(double part, double all, std::size_t machines) { return part * static_cast<double>(machines) / all; }

std::string count_text(const std::optional<std::size_t>& count, std::size_t tried) {
    return count ? fmt::format("{}", *count) : fmt::format("more than {}", tried);
}

std::string overload_text(const Plan& plan, const Loads::Overload& overload) {
    if (overload.machines == 0) return "none";
    return fmt::format("{} of {} nodes, {:.2f} h together, {:.2f} h the longest", overload.machines, plan.nodes,
                       in_seconds(overload.total) / 3600.0, in_seconds(overload.longest) / 3600.0);
}

std::string sizes_table(const Plan& plan, const Report& report) {
    const auto& [size, outcome, nodes] = report;
    const double robots = static_cast<double>(plan.robots);
    const double most = static_cast<double>(outcome.node_robots_max);
    Table table("figure | by arithmetic | simulated");
    table.add("scans per second | {:.0f} | ", size.scans_per_s);
    table.add("sessions at a time; robots of the largest | | {}; {}", outcome.sessions, outcome.largest_session);
    table.add("cores that all nodes use | {:.2f} | ", size.node_cores);
    table.add("cores of {:g} that a node uses: mean; the fullest, mean over the time; ever | {:.2f} | {:.2f}; {:.2f}",
              plan.node_cores, size.node_cores / static_cast<double>(plan.nodes),
              node_cores_of(plan, outcome.node_robots_mean), node_cores_of(plan, most));
    table.add("robots of the fullest node, relative to the mean: mean over the time; ever | 1 | {:.2f}; {:.2f}",
              share_of(outcome.node_robots_mean, robots, plan.nodes), share_of(most, robots, plan.nodes));
    table.add("nodes that needed more than their cores | | {}", overload_text(plan, outcome.overload));
    table.add("cores of {:g} that the primary uses; the standby | {:.2f}; {:.2f} | ", plan.database_cores,
              size.primary_cores, size.standby_cores);
    table.add("MB of log per second; TB per day | {:.1f}; {:.3f} | ", size.log_mbytes_per_s, size.log_tbytes_per_day);
    table.add("nodes needed for at most {:.0f} % with one down | {} | {}", 100.0 * kFullShare, size.nodes,
              count_text(nodes, 4 * size.nodes));
    table.add("clusters needed, each with one database, for at most {:.0f} % of it | {} | ", 100.0 * kFullShare,
              size.clusters);
    return table.text();
}

std::string waits_table(const Outcome& outcome) {
    Table table("a robot has no acknowledgements because | times | p99, s | longest, s");
    for (const Cause cause : kCauses) {
        const Waits& waits = outcome.waits_of(cause);
        if (waits.count == 0) continue;
        table.add("{} | {} | {:.3f} | {:.3f}", description_of(cause), waits.count, in_seconds(waits.percentile_99),
                  in_seconds(waits.longest));
    }
    return table.text();
}

std::string balances_table(const Outcome& outcome) {
    Table table("hour | nodes that run | emptiest node / mean | fullest / mean | when");
    for (const Balance& balance : outcome.balances) {
        table.add("{:.2f} | {} | {:.2f} | {:.2f} | {}", in_seconds(balance.time) / 3600.0, balance.nodes_up,
                  balance.emptiest, balance.fullest, balance.when);
    }
    return table.text();
}

std::string json_of(Cause cause, const Waits& waits) {
    return fmt::format(R"("{}":{{"count":{},"p99_s":{:.3f},"longest_s":{:.3f}}})", name_of(cause), waits.count,
                       in_seconds(waits.percentile_99), in_seconds(waits.longest));
}

std::string json_of(const Balance& balance) {
    return fmt::format(R"({{"hour":{:.4f},"nodes_up":{},"emptiest":{:.4f},"fullest":{:.4f}}})",
                       in_seconds(balance.time) / 3600.0, balance.nodes_up, balance.emptiest, balance.fullest);
}

std::string json_of(const std::optional<std::size_t>& count) { return count ? fmt::format("{}", *count) : "null"; }

std::string json_of(const Size& size) {
    return fmt::format(R"({{"scans_per_s":{:.1f},"node_cores":{:.4f},"primary_cores":{:.4f},"standby_cores":{:.4f},)"
                       R"("log_mb_per_s":{:.3f},"log_tb_per_day":{:.4f},"nodes":{},"clusters":{}}})",
                       size.scans_per_s, size.node_cores, size.primary_cores, size.standby_cores, size.log_mbytes_per_s,
                       size.log_tbytes_per_day, size.nodes, size.clusters);
}

} // namespace

Report report_of(const Plan& plan) { return {size_of(plan), simulate(plan), nodes_needed(plan)}; }

std::string tables_of(const Plan& plan, const Report& report) {
    const Outcome& outcome = report.outcome;
    const auto ends = [&](End end) { return outcome.ends[static_cast<std::size_t>(end)]; };
    return fmt::format("{} robots at {:g} Hz on {} nodes with a database, {:g} h\n\n{}\n\n"
                       "{} nodes were killed, {} fell silent, {} were stopped. {} sessions were taken over from nodes "
                       "that had failed, {} "
                       "after nodes had given them up, and {} were created. {} robots waited at the end.\n\n{}\n\n{}",
                       plan.robots, plan.rate_hz, plan.nodes, plan.duration_hours, sizes_table(plan, report),
                       ends(End::kKilled), ends(End::kSilent), ends(End::kStopped), outcome.taken_over, outcome.moved,
                       outcome.created, outcome.waiting, waits_table(outcome), balances_table(outcome));
}

std::string json_of(const Plan& plan, const Report& report) {
    const Outcome& outcome = report.outcome;
    std::string waits;
    for (const Cause cause : kCauses) {
        waits += (waits.empty() ? "" : ",") + json_of(cause, outcome.waits_of(cause));
    }
    std::string balances;
    for (const Balance& balance : outcome.balances) balances += (balances.empty() ? "" : ",") + json_of(balance);
    return fmt::format(
        R"({{"robots":{},"rate_hz":{:g},"seed":{},"size":{},"nodes_needed":{},"sessions":{},)"
        R"("largest_session":{},"created":{},"taken_over":{},"moved":{},"waiting":{},"fullest_node_cores":{:.4f},)"
        R"("overloaded_nodes":{},"overload_s":{:.3f},"waits":{{{}}},"balance":[{}]}})",
        plan.robots, plan.rate_hz, plan.seed, json_of(report.size), json_of(report.nodes_needed), outcome.sessions,
        outcome.largest_session, outcome.created, outcome.taken_over, outcome.moved, outcome.waiting,
        node_cores_of(plan, static_cast<double>(outcome.node_robots_max)), outcome.overload.machines,
        in_seconds(outcome.overload.total), waits, balances);
}

} // namespace scanloom::lab::cluster
