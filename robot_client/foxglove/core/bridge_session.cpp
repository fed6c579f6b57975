#include "robot_client/foxglove/core/bridge_session.hpp"

#include "robot_client/recordings/recording_lists.hpp"
#include "robot_client/ros/outgoing_messages.hpp"
#include "robot_client/ros/recording_survey.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <type_traits>
#include <utility>

namespace scanloom::robot::foxglove {
namespace {

struct NamedEncoding {
    std::string_view name;
    MessageEncoding encoding;
};

constexpr NamedEncoding kEncodings[] = {{"cdr", MessageEncoding::kCdr}, {"ros1", MessageEncoding::kRos1}};

MessageEncoding encoding_of(std::string_view name) {
    const auto* known = std::ranges::find(kEncodings, name, &NamedEncoding::name);
    return known == std::end(kEncodings) ? MessageEncoding::kOther : known->encoding;
}

std::string_view name_of(MessageEncoding encoding) {
    const auto* known = std::ranges::find(kEncodings, encoding, &NamedEncoding::encoding);
    return known == std::end(kEncodings) ? std::string_view() : known->name;
}

} // namespace

void BridgeSession::begin() {
    info_.reset();
    offered_.clear();
    subscriptions_.clear();
    ended_.clear();
    for (auto& publication : publications_) {
        publication.is_announced = false;
        publication.unsent.reset();
    }
}

Event BridgeSession::take_text(std::string_view text) { return take(decode_text(text)); }

Event BridgeSession::take_binary(std::string_view bytes) { return take(decode_binary(bytes)); }

Event BridgeSession::take(Result<Frame> frame) {
    if (!frame) {
        refuse(frame.error().message);
        return {};
    }
    return std::visit(
        [this](auto&& one) -> Event {
            using One = std::decay_t<decltype(one)>;
            if constexpr (std::is_same_v<One, Unneeded>) {
                return {};
            } else if constexpr (std::is_same_v<One, Status> || std::is_same_v<One, ServerTime>) {
                return std::forward<decltype(one)>(one);
            } else {
                return take(std::forward<decltype(one)>(one));
            }
        },
        std::move(*frame));
}

Event BridgeSession::take(ServerInfo info) {
    if (std::exchange(info_, std::move(info))) {
        refuse("a second serverInfo");
        return {};
    }
    return Connected{};
}

Event BridgeSession::take(Advertise advertise) {
    if (advertise.refused > 0) refused_["a channel without id, topic, encoding or schema"] += advertise.refused;
    for (auto& channel : advertise.channels) offer(std::move(channel));
    update_subscriptions();
    return TopicsChanged{};
}

/// Adds a channel. A channel whose id has another meaning than before replaces the earlier one.
void BridgeSession::offer(Channel channel) {
    if (const auto known = offered_.find(channel.id); known != offered_.end()) {
        if (known->second.channel == channel) return;
        refuse("an id of a channel that is in use");
        withdraw(channel.id);
    }
    if (offered_.size() == kChannelsMax) return refuse("a channel beyond 10,000");
    RecordedTopic topic{channel.topic, type_without_msg(channel.schema_name), encoding_of(channel.encoding)};
    const auto id = channel.id;
    offered_.emplace(id, Offered{std::move(channel), std::move(topic), std::nullopt});
}

Event BridgeSession::take(const Unadvertise& unadvertise) {
    for (const auto id : unadvertise.ids) {
        if (!offered_.contains(id)) refuse("an unadvertise of an unknown channel");
        withdraw(id);
    }
    update_subscriptions();
    return TopicsChanged{};
}

/// Removes a channel; a bridge ends its subscription by itself.
void BridgeSession::withdraw(std::uint64_t id) {
    const auto known = offered_.find(id);
    if (known == offered_.end()) return;
    if (const auto subscription = known->second.subscription) subscriptions_.erase(*subscription);
    offered_.erase(known);
}

Event BridgeSession::take(const MessageData& message) {
    const auto subscription = subscriptions_.find(message.subscription);
    if (subscription == subscriptions_.end()) {
        const bool has_ended = message.subscription > 0 && message.subscription < next_subscription_;
        if (!has_ended) refuse("a message of an unknown subscription");
        return {};
    }
    const Offered& offered = offered_.at(subscription->second);
    return Delivered{offered.topic, recorded_time(message.log_time), message.payload};
}

void BridgeSession::update_subscriptions() {
    std::set<std::pair<std::string, std::string>> subscribed; // topics with their types
    for (auto& [id, offered] : offered_) {
        if (!offered.subscription) continue;
        if (needed_(offered.topic)) {
            subscribed.emplace(offered.topic.name, offered.topic.type);
            continue;
        }
        if (offered.is_requested) ended_.push_back(*offered.subscription);
        subscriptions_.erase(*offered.subscription);
        offered.subscription.reset();
    }
    for (const bool are_transforms : {true, false}) { // a robot with very many topics is useless without transforms
        for (auto& [id, offered] : offered_) {
            if (offered.subscription || has_transforms(offered.topic) != are_transforms) continue;
            if (!needed_(offered.topic)) continue;
            if (!subscribed.emplace(offered.topic.name, offered.topic.type).second) continue;
            if (subscriptions_.size() == kSubscriptionsMax) return refuse("a topic beyond 256 that are subscribed to");
            offered.subscription = next_subscription_++;
            offered.is_requested = false;
            subscriptions_.emplace(*offered.subscription, id);
            has_unrequested_ = true;
        }
    }
}

std::vector<RecordedTopic> BridgeSession::topics() const {
    std::vector<RecordedTopic> topics;
    for (const auto& [id, offered] : offered_) topics.push_back(offered.topic);
    return topics;
}

// Publishing ----------------------------------------------------------------------------------------------------------

std::uint32_t BridgeSession::add_publication(std::string topic, std::string type) {
    publications_.push_back({std::move(topic), std::move(type)});
    return static_cast<std::uint32_t>(publications_.size() - 1);
}

std::optional<MessageEncoding> BridgeSession::publish_encoding() const {
    if (!info_ || std::ranges::find(info_->capabilities, "clientPublish") == info_->capabilities.end()) {
        return std::nullopt;
    }
    for (const auto& name : info_->supported_encodings) {
        if (const auto encoding = encoding_of(name); encoding != MessageEncoding::kOther) return encoding;
    }
    return std::nullopt;
}

std::string BridgeSession::publish_problem() const {
    if (publish_encoding()) return {};
    if (std::ranges::find(info_->capabilities, "clientPublish") == info_->capabilities.end()) {
        return "the bridge does not let clients publish: start foxglove_bridge with clientPublish among its "
               "capabilities";
    }
    return fmt::format(
        "the bridge takes messages of clients in none of the encodings cdr and ros1; it takes: {}",
        info_->supported_encodings.empty() ? "none" : fmt::to_string(fmt::join(info_->supported_encodings, ", ")));
}

void BridgeSession::publish(std::uint32_t publication, std::string payload) {
    if (publish_encoding()) publications_[publication].unsent = std::move(payload);
}

/// Returns the announcement of a publication that the bridge does not know.
std::optional<std::string> BridgeSession::next_announcement() {
    const auto encoding = publish_encoding();
    const auto next = std::ranges::find(publications_, false, &Publication::is_announced);
    if (!encoding || next == publications_.end()) return std::nullopt;
    next->is_announced = true;
    const auto number = static_cast<std::uint64_t>(next - publications_.begin());
    return encode_advertise({number, next->topic, std::string(name_of(*encoding)), type_in(next->type, *encoding)});
}

std::optional<std::string> BridgeSession::next_subscription_change() {
    if (!ended_.empty()) return encode_unsubscribe(std::exchange(ended_, {}));
    if (!std::exchange(has_unrequested_, false)) return std::nullopt;
    std::vector<Subscription> begun;
    for (auto& [id, offered] : offered_) {
        if (!offered.subscription || std::exchange(offered.is_requested, true)) continue;
        begun.push_back({*offered.subscription, id});
    }
    if (begun.empty()) return std::nullopt; // their channels have vanished again
    return encode_subscribe(begun);
}

std::optional<OutgoingFrame> BridgeSession::next_frame() {
    if (auto change = next_subscription_change()) return OutgoingFrame{std::move(*change)};
    if (auto announcement = next_announcement()) return OutgoingFrame{std::move(*announcement)};
    for (std::size_t n = 0; n < publications_.size(); ++n) {
        const auto number = next_publication_++ % publications_.size();
        if (const auto payload = std::exchange(publications_[number].unsent, std::nullopt)) {
            return OutgoingFrame{encode_message(static_cast<std::uint32_t>(number), *payload), true};
        }
    }
    return std::nullopt;
}

} // namespace scanloom::robot::foxglove
