#pragma once

#include "server/store/shared_sessions.hpp"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::sessions {

/// The servers that go on with the sessions of this one when it shuts down, if several share the log. Robots are sent
/// there.
/// Threads: any, concurrently.
class Successors {
public:
    /// Chooses a server for each session: the one with the fewest, counting those that were chosen before.
    /// @param sessions  names
    /// @param nodes     all servers; of these, others than this one that live and accept robots
    void choose(const std::vector<std::string>& sessions, std::vector<store::Node> nodes);

    /// Returns the server that goes on with a session; null: none is chosen.
    [[nodiscard]] std::shared_ptr<const store::NodeInfo> of(std::string_view session) const;

private:
    mutable std::mutex mutex_;
    std::map<std::string, std::shared_ptr<const store::NodeInfo>, std::less<>> chosen_; // by session
};

} // namespace scanloom::sessions
