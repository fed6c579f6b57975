#include "server/auth/refusals.hpp"

#include <utility>

namespace scanloom::auth {

std::vector<RefusalTable::Line> RefusalTable::note(Refusal refusal, double now) {
    std::vector<Line> lines;
    sweep(now, lines);
    Key key{refusal.who, refusal.port, refusal.reason};
    if (!kept_.contains(key) && kept_.size() >= kAddressesMax) {
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

} // namespace scanloom::auth
