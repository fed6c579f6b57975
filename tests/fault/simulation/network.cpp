#include "tests/fault/simulation/network.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::simulation {

using namespace std::chrono_literals;

namespace {

constexpr Duration kTroubleWithin = 3s; // after the connection is established

bool is_within(Time time, const Pause& pause) { return time >= pause.from && time < pause.until; }

} // namespace

std::shared_ptr<Connection> Connection::make(World& world, const NetworkTrouble& trouble) {
    if (world.chance(trouble.refuse) || std::ranges::any_of(trouble.partitions, [&](const Pause& partition) {
            return is_within(world.now(), partition);
        })) {
        return nullptr;
    }
    const std::shared_ptr<Connection> made(new Connection(world, trouble));
    if (!world.chance(trouble.cut)) return made;
    world.after(world.between(0ms, kTroubleWithin), [weak = std::weak_ptr(made)] {
        if (const auto alive = weak.lock()) alive->cut();
    });
    return made;
}

Connection::Connection(World& world, const NetworkTrouble& trouble)
    : world_(world), latency_(world.between(100us, 30ms)), pauses_(trouble.partitions) {
    const auto soon = [&] { return world_.now() + world_.between(0ms, kTroubleWithin); };
    if (world_.chance(trouble.stall)) {
        const Time from = soon();
        pauses_.push_back({from, from + world_.between(100ms, 30s)});
    }
    std::ranges::sort(pauses_, {}, &Pause::from); // so that one may follow another without a gap
    if (world_.chance(trouble.silent)) silent_from_.fill(soon());
    if (world_.chance(trouble.deaf)) silent_from_[world_.draw(silent_from_.size())] = soon();
    if (world_.chance(trouble.forge)) forge_ = 0.05;
}

void Connection::send(Side from, std::string bytes) {
    if (is_cut_ || world_.now() >= silent_from_[index(from)]) return;
    auto& kept_back = kept_back_[index(from)];
    if (!kept_back && world_.chance(forge_)) {
        kept_back = std::move(bytes);
        return;
    }
    const int times = world_.chance(forge_) ? 2 : 1;
    for (int n = 0; n < times; ++n) deliver(other(from), bytes);
    if (kept_back) deliver(other(from), *std::exchange(kept_back, std::nullopt));
}

Time Connection::arrival(Side from) {
    Time time = world_.now() + latency_ + world_.between(0us, 2ms);
    for (const auto& pause : pauses_) {
        if (is_within(time, pause)) time = pause.until;
    }
    auto& last = last_arrival_[index(from)];
    return last = std::max(last, time);
}

void Connection::deliver(Side to, std::string bytes) {
    world_.at(arrival(other(to)), [self = shared_from_this(), to, bytes = std::move(bytes)] { self->hear(to, bytes); });
}

/// Divides the data into pieces other than those sent.
void Connection::hear(Side to, const std::string& bytes) {
    for (std::size_t begin = 0; begin < bytes.size();) {
        const std::size_t rest = bytes.size() - begin;
        const std::size_t size = world_.chance(0.7) ? rest : 1 + world_.draw(rest);
        const auto heard = ears_[index(to)].on_bytes; // which may close this side
        if (!heard || is_cut_) return;
        heard(std::string_view(bytes).substr(begin, size));
        begin += size;
    }
}

void Connection::close(Side from) {
    ears_[index(from)] = {};
    if (is_cut_ || world_.now() >= silent_from_[index(from)]) return;
    world_.at(arrival(from), [self = shared_from_this(), to = other(from)] {
        const auto closed = std::exchange(self->ears_[index(to)], {}).on_closed;
        if (closed) closed();
    });
}

void Connection::vanish(Side from) {
    if (world_.chance(0.5)) return close(from);
    ears_[index(from)] = {};
    silent_from_[index(from)] = std::min(silent_from_[index(from)], world_.now());
}

void Connection::cut() {
    is_cut_ = true;
    for (auto& ears : ears_) {
        const auto closed = std::exchange(ears, {}).on_closed;
        if (closed) closed();
    }
}

} // namespace scanloom::simulation
