#pragma once

#include "robot_client/foxglove/core/protocol.hpp"
#include "robot_client/recordings/recording.hpp"
#include "robot_client/ros/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::robot::foxglove {

/// A message of a topic that is needed.
struct Delivered {
    const RecordedTopic& topic; ///< valid until the next call
    RosTime log_time = 0;       ///< when the bridge received it, in ns
    std::string_view payload;   ///< part of the frame
};

/// The bridge said what it is: the connection is usable.
struct Connected {};

/// The bridge offers other topics than before: see BridgeSession::topics().
struct TopicsChanged {};

/// What a frame means for the user of a session; std::monostate: nothing.
using Event = std::variant<std::monostate, Connected, TopicsChanged, Delivered, Status, ServerTime>;

/// A frame to send.
struct OutgoingFrame {
    std::string bytes;
    bool is_binary = false;
};

/// A client's side of the protocol as a state machine without sockets and clocks. It outlives its connections: topics
/// are subscribed to again on the next one, and publications are announced again.
///
/// A topic that several channels have is subscribed to once. When its channel vanishes, another one, or a later one of
/// the same topic, is subscribed to, whatever its id.
/// Threads: one at a time.
class BridgeSession {
public:
    using Needed = std::function<bool(const RecordedTopic&)>;

    /// Channels of a bridge that are remembered, and topics that are subscribed to; further ones are refused.
    static constexpr std::size_t kChannelsMax = 10'000;
    static constexpr std::size_t kSubscriptionsMax = 256;

    /// @param needed  whether a topic is needed
    explicit BridgeSession(Needed needed) : needed_(std::move(needed)) {}

    /// Begins a connection. Nothing of the one before holds any more.
    void begin();

    /// Takes a received frame. A frame that is refused is counted, and changes nothing.
    [[nodiscard]] Event take_text(std::string_view text);
    [[nodiscard]] Event take_binary(std::string_view bytes);

    /// Subscribes and unsubscribes after `needed` has changed its answers.
    void update_subscriptions();

    /// Announces a channel of this client, on this connection and later ones.
    /// @param type  without "msg/"
    /// @return its number, for publish()
    std::uint32_t add_publication(std::string topic, std::string type);
    /// Returns how messages to publish must be encoded; nullopt if the bridge takes none.
    [[nodiscard]] std::optional<MessageEncoding> publish_encoding() const;
    /// Returns why the bridge takes no messages, for people; empty if it does. Pre: is_connected().
    [[nodiscard]] std::string publish_problem() const;
    /// Publishes a message. It replaces one of the same channel that is not sent yet, so that a slow connection gets
    /// the newest ones. Ignored if the bridge takes no messages.
    void publish(std::uint32_t publication, std::string payload);

    /// Returns the next frame to send.
    [[nodiscard]] std::optional<OutgoingFrame> next_frame();

    [[nodiscard]] bool is_connected() const { return info_.has_value(); }
    /// Returns what the bridge offers now.
    [[nodiscard]] std::vector<RecordedTopic> topics() const;
    /// Returns the number of frames, or parts of them, that were refused, by the reason, on all connections.
    [[nodiscard]] const std::map<std::string, std::uint64_t>& refused() const noexcept { return refused_; }

private:
    struct Offered {
        Channel channel;
        RecordedTopic topic;
        std::optional<std::uint32_t> subscription;
        bool is_requested = false; // the subscription was sent
    };

    struct Publication {
        std::string topic;
        std::string type;
        bool is_announced = false;         // on this connection
        std::optional<std::string> unsent; // the newest message
    };

    [[nodiscard]] Event take(Result<Frame> frame);
    [[nodiscard]] Event take(ServerInfo info);
    [[nodiscard]] Event take(Advertise advertise);
    [[nodiscard]] Event take(const Unadvertise& unadvertise);
    [[nodiscard]] Event take(const MessageData& message);
    void offer(Channel channel);
    void withdraw(std::uint64_t id);
    [[nodiscard]] std::optional<std::string> next_announcement();
    [[nodiscard]] std::optional<std::string> next_subscription_change();
    void refuse(const std::string& reason) { ++refused_[reason]; }

    Needed needed_;
    std::optional<ServerInfo> info_;
    std::map<std::uint64_t, Offered> offered_;             // by id of the channel
    std::map<std::uint32_t, std::uint64_t> subscriptions_; // id of the channel by id of the subscription
    std::uint32_t next_subscription_ = 1;
    bool has_unrequested_ = false;     // subscriptions
    std::vector<std::uint32_t> ended_; // subscriptions that the bridge does not know to be ended
    std::vector<Publication> publications_;
    std::size_t next_publication_ = 0; // whose message is sent next, in turn
    std::map<std::string, std::uint64_t> refused_;
};

} // namespace scanloom::robot::foxglove
