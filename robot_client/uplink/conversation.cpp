#include "robot_client/uplink/conversation.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/frame_decoder.hpp"
#include "robot_client/source/seconds.hpp"
#include "robot_client/uplink/server_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace scanloom::robot {
namespace {

/// Pings that may be unanswered here; a server never sends more.
constexpr std::size_t kPingsToAnswerMax = 16;

/// Bytes of the frame and batch fields around the scans of a batch, including the length prefix.
constexpr std::size_t kBatchOverhead = wire::kLengthPrefixBytes + 16;

wire::LinkError retry(Errc code, std::string message) { return {{code, std::move(message)}, true}; }
wire::LinkError give_up(Error error) { return {std::move(error), false}; }

/// Makes the message of a server's failure safe to show.
wire::LinkError in_plain_text(wire::LinkError failure) {
    auto& [code, message] = failure.error;
    message = message.empty()
                  ? fmt::format("the server ended the link with the error {} and did not say why", name_of(code))
                  : shown(message);
    return failure;
}

/// Replaces limits that the server did not state by the protocol's limits.
wire::Limits with_defaults(wire::Limits limits) {
    if (limits.frame_size_max == 0) limits.frame_size_max = wire::kFrameBytesMax;
    if (limits.beams_max == 0) limits.beams_max = kBeamsMax;
    if (limits.scans_per_batch_max == 0) limits.scans_per_batch_max = kScansPerBatchMax;
    return limits;
}

} // namespace

Conversation::Conversation(ConversationOptions options, Time now)
    : options_(std::move(options)), buffer_(options_.buffer_bytes_max), progress_(now) {
    if (options_.compress) compressor_.emplace();
}

void Conversation::open(Time now) {
    link_.emplace();
    link_->opened = link_->heard = now;
}

void Conversation::close() {
    link_.reset();
    requests_.rewind();
}

std::optional<wire::LinkError> Conversation::receive(const wire::Message& message, Time now) {
    assert(link_);
    link_->heard = now;
    if (const auto* failure = std::get_if<wire::LinkError>(&message)) return on_error(*failure, now);
    if (const auto* goodbye = std::get_if<wire::Goodbye>(&message)) {
        return retry(Errc::kShuttingDown, goodbye->reason.empty()
                                              ? "the server said goodbye without a reason"
                                              : "the server said goodbye: " + shown(goodbye->reason));
    }
    if (const auto* ping = std::get_if<wire::Ping>(&message)) {
        if (link_->pings_to_answer.size() == kPingsToAnswerMax) {
            return retry(Errc::kMalformed, "the server sends pings faster than they can be answered");
        }
        link_->pings_to_answer.push_back(ping->nonce);
        return std::nullopt;
    }
    if (std::holds_alternative<wire::Pong>(message)) return std::nullopt;
    const auto* welcome = std::get_if<wire::Welcome>(&message);
    if (welcome && link_->said_hello && !link_->welcomed) return on_welcome(*welcome, now);
    if (link_->welcomed) {
        if (const auto* ack = std::get_if<wire::Ack>(&message)) return on_ack(*ack, now);
        if (std::holds_alternative<wire::Correction>(message))
            return std::nullopt; // ignored: poses are sent as the source gives them
        if (requests_.answer(message)) return std::nullopt;
    }
    return retry(Errc::kMalformed, fmt::format("the server sent an unexpected {}", wire::name_of(message)));
}

wire::LinkError Conversation::on_error(wire::LinkError failure, Time now) {
    failure = in_plain_text(std::move(failure));
    if (failure.error.code == Errc::kMalformed && requests_.is_locating()) {
        failure.error.message += "; a server of an earlier version cannot tell a robot where it is: update it, or say "
                                 "where the robot is";
    }
    if (failure.error.code != Errc::kReplaced) return failure;
    failure.retryable = replacements_.may_pass(now);
    if (!failure.retryable) {
        failure.error.message +=
            fmt::format("; that happened {} times within {} s, so another program uses the same --robot and --session",
                        Replacements::kMax, Replacements::kWithin.count());
    }
    return failure;
}

std::optional<wire::LinkError> Conversation::on_welcome(const wire::Welcome& welcome, Time now) {
    if (!resumed_after_) {
        resumed_after_ = welcome.last_durable_seq;
        buffer_.start_after(welcome.last_durable_seq);
        progress_ = now;
    } else {
        const bool made_anew = welcome.session_id != session_id_ && buffer_.acknowledged() > 0;
        if (made_anew) {
            return give_up({Errc::kGone, fmt::format("session {} was deleted and made anew while {} of its scans were "
                                                     "acknowledged; start again to fill the new one",
                                                     options_.hello.session, buffer_.acknowledged())});
        }
        const std::uint64_t acknowledged_before = buffer_.acknowledged();
        if (auto ok = buffer_.rewind(welcome.last_durable_seq); !ok) return give_up(ok.error());
        if (buffer_.acknowledged() > acknowledged_before) progress_ = now;
    }
    session_id_ = welcome.session_id;
    applied_ = std::max(applied_, welcome.last_durable_seq);
    link_->welcomed = true;
    link_->limits = with_defaults(welcome.limits);
    link_->zstd = welcome.zstd;
    link_->credit.reset(welcome.credit_bytes);
    ++welcomes_;
    return std::nullopt;
}

std::optional<wire::LinkError> Conversation::on_ack(const wire::Ack& ack, Time now) {
    if (ack.durable_seq > buffer_.sent()) {
        return retry(Errc::kMalformed, fmt::format("the server acknowledged scan {}, only {} were sent",
                                                   ack.durable_seq, buffer_.sent()));
    }
    if (ack.durable_seq > buffer_.acknowledged()) {
        buffer_.acknowledge(ack.durable_seq);
        progress_ = now;
    }
    applied_ = std::max(applied_, ack.applied_seq);
    link_->credit.durable(ack.durable_seq);
    link_->credit.set_credit(ack.credit_bytes);
    return std::nullopt;
}

std::optional<std::string> Conversation::next_frame(Time now) {
    auto message = next_message(now);
    if (!message) return std::nullopt;
    std::string frame;
    if (const auto* batch = std::get_if<wire::ScanBatch>(&*message)) {
        write_batch(*batch, frame);
    } else {
        wire::encode(*message, frame);
    }
    bytes_sent_ += frame.size();
    return frame;
}

/// Credit counts uncompressed bytes: what the server holds, not what is transmitted.
void Conversation::write_batch(const wire::ScanBatch& batch, std::string& frame) {
    wire::encode(batch, frame);
    link_->credit.sent(batch.scans.back().seq, frame.size());
    if (!compressor_ || !link_->zstd) return;
    const auto compressed = compressor_->compress(std::string_view(frame).substr(wire::kLengthPrefixBytes));
    if (!compressed) return;
    frame.clear();
    wire::encode(*compressed, frame);
}

std::optional<wire::Message> Conversation::next_message(Time now) {
    if (!link_ || link_->said_goodbye) return std::nullopt;
    if (!link_->said_hello) {
        link_->said_hello = true;
        return options_.hello;
    }
    if (!link_->welcomed) return std::nullopt;
    if (!link_->pings_to_answer.empty()) {
        const wire::Pong pong{link_->pings_to_answer.front()};
        link_->pings_to_answer.pop_front();
        return pong;
    }
    if (now >= ping_due()) {
        link_->pinged = now;
        return wire::Ping{++nonce_};
    }
    if (is_done()) {
        link_->said_goodbye = true;
        return wire::Goodbye{"every scan is acknowledged"};
    }
    if (auto request = requests_.next()) return request; // a caller waits for the reply
    return next_about_scans(now);
}

std::optional<wire::Message> Conversation::next_about_scans(Time now) {
    if (buffer_.unsent_count() == 0) return std::nullopt;
    const auto& sensor = buffer_.unsent(0).sensor;
    auto& described = link_->described[sensor->id];
    if (!described || (described != sensor && *described != *sensor)) {
        described = sensor;
        return *sensor;
    }
    const std::size_t count = scans_that_fit();
    if (count == 0 || waits_for_others(count, now)) return std::nullopt;
    wire::ScanBatch batch;
    batch.scans.reserve(count);
    for (std::size_t i = 0; i < count; ++i) batch.scans.push_back(buffer_.unsent(i).scan);
    buffer_.mark_sent(count);
    if (buffer_.unsent_count() == 0) unsent_since_.reset();
    return batch;
}

/// Returns whether to wait for more scans to share the batch with the `fitting` ones.
bool Conversation::waits_for_others(std::size_t fitting, Time now) const {
    const bool is_all = fitting == buffer_.unsent_count() && !ended_ && fitting < link_->limits.scans_per_batch_max;
    return is_all && unsent_since_ && now < *unsent_since_ + options_.batch_delay;
}

/// Returns how many unsent scans go into the next batch: those whose sensor was described, within the credit, the
/// server's limits and batch_bytes_max. The first scan may exceed batch_bytes_max.
std::size_t Conversation::scans_that_fit() {
    const wire::Limits& limits = link_->limits;
    const std::uint64_t frame_max = limits.frame_size_max + wire::kLengthPrefixBytes;
    const std::size_t count_max = std::min<std::size_t>(buffer_.unsent_count(), limits.scans_per_batch_max);
    std::size_t bytes = kBatchOverhead;
    for (std::size_t i = 0; i < count_max; ++i) {
        const Observation& next = buffer_.unsent(i);
        bytes += wire_bytes_max(next.scan);
        if (next.scan.ranges.size() > limits.beams_max || (i == 0 && bytes > frame_max)) {
            if (i > 0) return i;
            link_->cannot_send = {Errc::kTooLarge,
                                  fmt::format("scan {} has {} beams, the server takes at most {} and frames of "
                                              "at most {} bytes",
                                              next.scan.seq, next.scan.ranges.size(), limits.beams_max,
                                              limits.frame_size_max)};
            return 0;
        }
        const auto described = link_->described.find(next.sensor->id);
        const bool is_described = described != link_->described.end() &&
                                  (described->second == next.sensor || *described->second == *next.sensor);
        const std::uint64_t bytes_max =
            std::min(link_->credit.available(),
                     i == 0 ? frame_max : std::min<std::uint64_t>(frame_max, options_.batch_bytes_max));
        if (!is_described || bytes > bytes_max) return i;
    }
    return count_max;
}

std::optional<wire::LinkError> Conversation::check(Time now) const {
    if (!link_) return std::nullopt;
    if (link_->cannot_send) return give_up(*link_->cannot_send);
    if (!link_->welcomed && now >= link_->opened + options_.welcome_timeout) {
        return retry(Errc::kTimeout, fmt::format("the server did not answer the hello within {:g} s",
                                                 seconds(options_.welcome_timeout)));
    }
    if (link_->welcomed && now >= link_->heard + options_.silence_max) {
        return retry(Errc::kTimeout,
                     fmt::format("nothing came from the server for {:g} s", seconds(options_.silence_max)));
    }
    return std::nullopt;
}

Conversation::Time Conversation::ping_due() const {
    return std::max(link_->heard, link_->pinged.value_or(link_->heard)) + options_.ping_after;
}

Conversation::Time Conversation::deadline(Time now) const {
    if (!link_) return Time::max();
    if (!link_->welcomed) return link_->opened + options_.welcome_timeout;
    if (link_->said_goodbye) return link_->heard + options_.silence_max;
    const Time of_link = std::min(ping_due(), link_->heard + options_.silence_max);
    const Time batch_due = unsent_since_.value_or(now) + options_.batch_delay;
    return batch_due > now ? std::min(of_link, batch_due) : of_link;
}

void Conversation::add(Observation observation, Time now) {
    assert(!ended_);
    if (buffer_.empty()) progress_ = now; // no scan was waiting until now
    if (!unsent_since_) unsent_since_ = now;
    buffer_.push(std::move(observation));
}

std::optional<Conversation::Time> Conversation::stalled_since() const {
    if (resumed_after_ && buffer_.empty()) return std::nullopt;
    return progress_;
}

} // namespace scanloom::robot
