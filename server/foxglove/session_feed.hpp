#pragma once

#include "server/foxglove/protocol.hpp"
#include "server/foxglove/session_view.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::foxglove {

/// A message to a viewer.
struct Outgoing {
    std::string bytes;                                 ///< the message, or its beginning
    std::shared_ptr<const std::string> rest = nullptr; ///< follows `bytes`; other viewers may share it
    bool is_text = false;                              ///< otherwise binary
};

/// The conversation with one viewer of a session, by the protocol of Foxglove, without a socket.
///
/// Topics: those of topics.hpp. A channel sends the newest state when it is subscribed and when it has changed: /tf,
/// poses and scans in each turn, all others at most once a second; states in between are left out. Memory: what was
/// subscribed, and the number of each robot's channels.
/// Threads: one at a time.
class SessionFeed {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr std::size_t kWarningsMax = 16; ///< in one turn

    /// @param session     its name
    /// @param session_id  see server_info_text()
    SessionFeed(std::string session, std::string session_id)
        : session_(std::move(session)), session_id_(std::move(session_id)) {}

    /// Handles a message of the viewer. What it does wrong is answered with warnings in next(), kWarningsMax at most.
    void receive(std::string_view message, bool is_text);

    /// Returns what the viewer gets now. First of all, it is greeted.
    /// @param state  of the session, not older than in the call before
    [[nodiscard]] std::vector<Outgoing> next(const SessionView& state, Clock::time_point now);

    /// Returns when to call next() again although nothing changes.
    [[nodiscard]] Clock::time_point look_again() const noexcept { return look_again_; }

    /// Returns whether the viewer sees landmarks, which are searched for only then.
    [[nodiscard]] bool wants_landmarks() const { return wants(Content::kLandmarks); }
    /// Returns whether the viewer sees any of the parts with SessionView::parts_revision.
    [[nodiscard]] bool wants_parts() const {
        return wants(Content::kMap) || wants(Content::kFrontiers) || wants(Content::kPoseGraph);
    }

private:
    /// What a channel shows.
    enum class Content {
        kMap,
        kTransforms,
        kStatus,
        kLandmarks,
        kFrontiers,
        kGoals,
        kPoseGraph,
        kPose,
        kScan,
        kTrail,
        kPath
    };

    struct Channel {
        std::string topic;
        Message message;
        Content content;
        std::optional<RobotIndex> robot = std::nullopt; ///< whose channel it is; nullopt: that of the session
        std::uint32_t sensor = 0;                       ///< of kScan
    };

    /// Changes when what a channel shows does.
    using Version = std::pair<std::uint64_t, std::uint64_t>;

    struct Subscription {
        std::size_t channel = 0; ///< index
        std::optional<Version> sent;
        Clock::time_point due;
    };

    void handle(const Subscribe& subscribe);
    void handle(const Unsubscribe& unsubscribe);
    void warn(std::string_view text);
    [[nodiscard]] bool wants(Content content) const;
    void add_channels(const SessionView& state);
    void add_channel(Channel channel);
    [[nodiscard]] static Version version_of(const Channel& channel, const SessionView& state);
    [[nodiscard]] static Clock::duration pause_of(Content content);
    [[nodiscard]] static std::shared_ptr<const std::string> message_of(const Channel& channel,
                                                                       const SessionView& state);
    void warn_of_large_map();

    std::string session_;
    std::string session_id_;
    bool is_greeted_ = false;
    bool is_warned_ = false; // of a map that is too large
    std::vector<Outgoing> answers_;
    std::vector<Channel> channels_; ///< the id of a channel is its index plus one
    std::size_t advertised_ = 0;    ///< number of channels that the viewer knows
    std::map<std::string, std::size_t, std::less<>> by_topic_;
    std::map<std::uint32_t, Subscription> subscriptions_; ///< by the viewer's id
    Clock::time_point look_again_ = Clock::time_point::max();
};

} // namespace scanloom::foxglove
