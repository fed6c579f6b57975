#include "server/sessions/successors.hpp"

#include <algorithm>

namespace scanloom::sessions {

void Successors::choose(const std::vector<std::string>& sessions, std::vector<store::Node> nodes) {
    std::erase_if(nodes,
                  [](const store::Node& node) { return !node.is_alive || node.is_self || node.info->robots.empty(); });
    if (nodes.empty()) return;
    const std::lock_guard lock(mutex_);
    for (const auto& session : sessions) {
        store::Node& emptiest = *std::ranges::min_element(nodes, {}, &store::Node::sessions);
        ++emptiest.sessions;
        chosen_[session] = emptiest.info;
    }
}

std::shared_ptr<const store::NodeInfo> Successors::of(std::string_view session) const {
    const std::lock_guard lock(mutex_);
    const auto found = chosen_.find(session);
    return found == chosen_.end() ? nullptr : found->second;
}

} // namespace scanloom::sessions
