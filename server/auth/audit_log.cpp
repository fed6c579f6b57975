#include "server/auth/audit_log.hpp"

#include "common/scan/limits.hpp"
#include "server/log/context.hpp"

#include <fmt/format.h>
#include <prometheus/family.h>

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::auth {
namespace {

constexpr double kBetweenStrangers = 1.0; // seconds

/// Returns text from a client only if it is a valid name, which has neither spaces nor line breaks.
std::string_view name_or(std::string_view text, std::string_view otherwise) {
    if (text.empty()) return "-";
    return is_valid_name(text) ? text : otherwise;
}

void tell(const RefusalTable::Line& line) {
    const auto& [port, reason, who, token, session] = line.newest;
    log::warn({.session = is_valid_name(session) ? std::string_view(session) : "", .peer = who},
              "event=refused port={} who={} token={} reason={} session={} count={}", name_of(port), who,
              name_or(token, "?"), name_of(reason), name_or(session, "?"), line.count);
}

} // namespace

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
    for (const auto& line : table_.rest()) tell(line);
}

void AuditLog::note(Refusal refusal) {
    counters_.of(refusal.port, refusal.reason).Increment();
    std::vector<RefusalTable::Line> lines;
    {
        const std::lock_guard lock(mutex_);
        lines = table_.note(std::move(refusal), now_());
    }
    for (const auto& line : lines) tell(line);
}

void AuditLog::log_due() {
    std::vector<RefusalTable::Line> lines;
    {
        const std::lock_guard lock(mutex_);
        lines = table_.due(now_());
    }
    for (const auto& line : lines) tell(line);
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
