#include "server/ingest/connection_limits.hpp"

#include <fmt/format.h>

namespace scanloom::ingest {

ConnectionLimits::Decision ConnectionLimits::on_accepted() {
    const bool full = served() >= links_max_;
    if (full && count(State::kLeaving) >= kTurnedAwayMax) return {Admission::kClose};
    Decision decision{full ? Admission::kTurnAway : Admission::kServe, ++last_};
    if (!full && without_hello_.size() >= greeting_max_) { // the oldest is the least likely to be a robot
        decision.cut_off = *without_hello_.begin();
        change(open_.find(*decision.cut_off), State::kLeaving);
    }
    const auto state = full ? State::kLeaving : State::kWithoutHello;
    open_.emplace(decision.id, state);
    if (!full) without_hello_.insert(decision.id);
    ++counts_[static_cast<std::size_t>(state)];
    return decision;
}

void ConnectionLimits::on_hello(Id id) {
    const auto known = open_.find(id);
    if (known != open_.end() && known->second == State::kWithoutHello) change(known, State::kServed);
}

void ConnectionLimits::on_closed(Id id) {
    const auto known = open_.find(id);
    if (known == open_.end()) return;
    change(known, State::kLeaving);
    --counts_[static_cast<std::size_t>(State::kLeaving)];
    open_.erase(known);
}

wire::LinkError ConnectionLimits::too_many() const {
    return {{Errc::kOverloaded,
             fmt::format("{} robots are connected, the most this server takes; try again later", links_max_)},
            true};
}

void ConnectionLimits::change(std::map<Id, State>::iterator connection, State state) {
    --counts_[static_cast<std::size_t>(connection->second)];
    ++counts_[static_cast<std::size_t>(state)];
    connection->second = state;
    without_hello_.erase(connection->first); // no connection returns to this state
}

} // namespace scanloom::ingest
