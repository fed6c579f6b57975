#include "lab/cluster_servers.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::lab::cluster {

std::uint32_t Order::first() const {
    Rank best = rank_of(0);
    for (std::uint32_t node = 1; node < nodes_; ++node) best = std::max(best, rank_of(node));
    return best.second;
}

std::uint32_t Order::after(std::uint32_t node) const {
    const Rank before = rank_of(node);
    std::optional<Rank> next;
    for (std::uint32_t other = 0; other < nodes_; ++other) {
        const Rank rank = rank_of(other);
        if (rank < before && (!next || rank > *next)) next = rank;
    }
    return next ? next->second : first();
}

bool Servers::choose_another(std::optional<std::size_t> named, const Order& order) {
    if (named && redirects_ < kRedirectsMax) {
        ++redirects_;
        is_short_ = true;
        sent_to_ = static_cast<std::uint32_t>(*named);
        return true;
    }
    redirects_ = 0;
    if (std::exchange(sent_to_, kNone) != kNone) return false;
    next_ = order.after(next_);
    tried_ = (tried_ + 1) % order.nodes();
    return tried_ != 0;
}

} // namespace scanloom::lab::cluster
