#include "server/auth/audit_log.hpp"

#include "common/scan/limits.hpp"
#include "server/log/context.hpp"

#include <fmt/format.h>
#include <prometheus/family.h>

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::auth {
namespace {

constexpr double kBetweenStrangers = 1.0; // seconds

/// Returns text from a client only if it is a valid name, which has neither spaces nor line breaks.
std::string_view name_or(std::string_view text, std::string_view otherwise) {
    if (text.empty()) return "-";
    return is_valid_name(text) ? text : otherwise;
}

void log_line(const RefusalTable::Line& line) {
    const auto& [port, reason, who, token, session] = line.newest;
    log::warn({.session = is_valid_name(session) ? std::string_view(session) : "", .peer = who},
              "event=refused port={} who={} token={} reason={} session={} count={}", name_of(port), who,
              name_or(token, "?"), name_of(reason), name_or(session, "?"), line.count);
}

} // namespace

std::vector<RefusalTable::Line> RefusalTable::note(Refusal refusal, double now) {
    std::vector<Line> lines;
    sweep(now, lines);
    Key key{refusal.who, refusal.port, refusal.reason};
    if (!kept_.contains(key) && kept_.size() >= kEntriesMax) {
        refusal.who = kOthers;
        std::get<0>(key) = kOthers;
    }
    const auto [entry, is_new] = kept_.try_emplace(std::move(key));
    Kept& kept = entry->second;
    kept.newest = std::move(refusal);
    ++kept.unlogged;
    if (is_new) {
        lines.push_back({kept.newest, std::exchange(kept.unlogged, 0)});
        kept.logged = now;
    }
    return lines;
}

std::vector<RefusalTable::Line> RefusalTable::due(double now) {
    std::vector<Line> lines;
    sweep(now, lines);
    return lines;
}

/// Appends the lines that are due, and removes entries without refusals since their last line. Runs at most once per
/// second.
void RefusalTable::sweep(double now, std::vector<Line>& lines) {
    if (now - swept_ < 1.0) return;
    swept_ = now;
    for (auto entry = kept_.begin(); entry != kept_.end();) {
        Kept& kept = entry->second;
        if (now - kept.logged < kPauseSeconds) {
            ++entry;
        } else if (kept.unlogged == 0) {
            entry = kept_.erase(entry);
        } else {
            lines.push_back({kept.newest, std::exchange(kept.unlogged, 0)});
            kept.logged = now;
            ++entry;
        }
    }
}

std::vector<RefusalTable::Line> RefusalTable::rest() {
    std::vector<Line> lines;
    for (auto& [key, kept] : kept_) {
        if (kept.unlogged > 0) lines.push_back({kept.newest, std::exchange(kept.unlogged, 0)});
    }
    return lines;
}

RefusalCounters::RefusalCounters(prometheus::Registry& registry) {
    auto& family = prometheus::BuildCounter()
                       .Name("scanloom_refusals_total")
                       .Help("Refused connections and requests, by port and reason.")
                       .Register(registry);
    for (const auto port : kPorts) {
        for (const auto reason : kReasons) {
            counters_[static_cast<std::size_t>(port)][static_cast<std::size_t>(reason)] =
                &family.Add({{"port", std::string(name_of(port))}, {"reason", std::string(name_of(reason))}});
        }
    }
}

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

AuditLog::~AuditLog() {
    for (const auto& line : table_.rest()) log_line(line);
}

void AuditLog::note(Refusal refusal) {
    counters_.of(refusal.port, refusal.reason).Increment();
    std::vector<RefusalTable::Line> lines;
    {
        const std::lock_guard lock(mutex_);
        lines = table_.note(std::move(refusal), now_());
    }
    for (const auto& line : lines) log_line(line);
}

void AuditLog::log_due() {
    std::vector<RefusalTable::Line> lines;
    {
        const std::lock_guard lock(mutex_);
        lines = table_.due(now_());
    }
    for (const auto& line : lines) log_line(line);
}

std::optional<std::uint64_t> AuditLog::admit_log_line() {
    const std::lock_guard lock(mutex_);
    const double now = now_();
    if (stranger_logged_ && now < *stranger_logged_ + kBetweenStrangers) {
        ++strangers_unlogged_;
        return std::nullopt;
    }
    stranger_logged_ = now;
    return std::exchange(strangers_unlogged_, 0);
}

void AuditLog::note(Port port, const std::string& who, net::ClientFault fault) {
    const bool is_missing = fault == net::ClientFault::kMissing;
    note({port, is_missing ? Reason::kNoCertificate : Reason::kForeignCertificate, who, {}, {}});
}

} // namespace scanloom::auth
