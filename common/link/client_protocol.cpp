#include "common/link/client_protocol.hpp"

#include "common/link/printable_text.hpp"
#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace scanloom::link {
namespace {

/// Pings that may be unanswered here; a server never sends more.
constexpr std::size_t kPingsToAnswerMax = 16;

/// Bytes of the frame and batch fields around the scans of a batch, including the length prefix.
constexpr std::size_t kBatchOverhead = wire::kLengthPrefixBytes + 16;

/// A link that is replaced this often within this time is replaced by another program.
constexpr std::size_t kReplacementsMax = 3;
constexpr std::chrono::seconds kReplacementsWithin{60};

wire::LinkError retry(Errc code, std::string message) { return {{code, std::move(message)}, true}; }
wire::LinkError give_up(Error error) { return {std::move(error), false}; }

double seconds_in(std::chrono::milliseconds duration) { return std::chrono::duration<double>(duration).count(); }

/// Makes the message of a server's failure safe to show.
wire::LinkError in_plain_text(wire::LinkError failure) {
    auto& [code, message] = failure.error;
    message = message.empty()
                  ? fmt::format("the server ended the link with the error {} and gave no reason", name_of(code))
                  : printable(message);
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

ClientProtocol::ClientProtocol(ClientProtocolOptions options, ScanQueue& scans, Time now)
    : options_(std::move(options)), scans_(scans), progress_(now) {
    if (options_.compress) compressor_.emplace();
}

void ClientProtocol::open(std::string server, Time now, bool has_others) {
    link_.emplace(std::move(server), has_others, now);
}

void ClientProtocol::close() {
    link_.reset();
    requests_.rewind();
}

// Receiving -----------------------------------------------------------------------------------------------------------

std::optional<wire::LinkError> ClientProtocol::on_bytes(std::size_t count, Time now) {
    link_->decoder.commit(count);
    for (;;) {
        const auto body = link_->decoder.next();
        if (!body) return unreadable(body.error());
        if (!*body) return std::nullopt;
        const auto message = wire::decode(**body);
        if (!message) return unreadable(message.error());
        if (auto failure = take(*message, now)) return failure;
    }
}

/// Makes the error for bytes that are not valid frames. Before the welcome they mean that another program listens
/// there.
wire::LinkError ClientProtocol::unreadable(const Error& error) const {
    if (link_->welcomed) return {prefixed("the data from the server cannot be read: ", error), true};
    return {{Errc::kMalformed, fmt::format("the program at {} does not speak Scanloom's robot link; give the server's "
                                           "robot port to --server",
                                           link_->server)},
            link_->has_others};
}

std::optional<wire::LinkError> ClientProtocol::take(const wire::Message& message, Time now) {
    link_->heard = now;
    if (const auto* failure = std::get_if<wire::LinkError>(&message)) return on_error(*failure, now);
    if (const auto* goodbye = std::get_if<wire::Goodbye>(&message)) {
        return retry(Errc::kShuttingDown, goodbye->reason.empty()
                                              ? "the server said goodbye without a reason"
                                              : "the server said goodbye: " + printable(goodbye->reason));
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
        if (const auto* correction = std::get_if<wire::Correction>(&message)) {
            if (options_.on_correction) options_.on_correction(*correction);
            return std::nullopt;
        }
        if (requests_.answer(message)) return std::nullopt;
    }
    return retry(Errc::kMalformed, fmt::format("the server sent an unexpected {}", wire::name_of(message)));
}

wire::LinkError ClientProtocol::on_error(wire::LinkError failure, Time now) {
    failure = in_plain_text(std::move(failure));
    if (failure.error.code == Errc::kMalformed && requests_.is_locating()) {
        failure.error.message +=
            "; servers of earlier versions cannot localize robots: update the server, or give the robot's pose";
    }
    if (failure.error.code != Errc::kReplaced) return failure;
    failure.retryable = may_be_replaced(now);
    if (!failure.retryable) {
        failure.error.message +=
            fmt::format("; that happened {} times within {} s, so another program uses the same --robot and --session",
                        kReplacementsMax, kReplacementsWithin.count());
    }
    return failure;
}

/// Records that a link was replaced, and decides whether to connect again. Either an earlier link of this program is
/// the cause, whose hello arrived late over a stalled network; then a retry helps. Or another program uses the same
/// name; then both would replace each other forever.
bool ClientProtocol::may_be_replaced(Time now) {
    std::erase_if(replaced_, [&](Time time) { return time + kReplacementsWithin <= now; });
    replaced_.push_back(now);
    return replaced_.size() < kReplacementsMax;
}

std::optional<wire::LinkError> ClientProtocol::on_welcome(const wire::Welcome& welcome, Time now) {
    if (auto contradiction = agree_on_scans(welcome, now)) return give_up(std::move(*contradiction));
    session_id_ = welcome.session_id;
    applied_ = std::max(applied_, welcome.last_durable_seq);
    link_->welcomed = true;
    link_->limits = with_defaults(welcome.limits);
    link_->zstd = welcome.zstd;
    link_->credit.reset(welcome.credit_bytes);
    ++welcomes_;
    return std::nullopt;
}

/// Lets the queue follow the server's scans.
/// @return why the server's scans contradict those sent from here, if they do
std::optional<Error> ClientProtocol::agree_on_scans(const wire::Welcome& welcome, Time now) {
    const bool is_first = !resumed_after_;
    if (is_first && options_.continues_earlier_run) {
        scans_.start_after(welcome.last_durable_seq);
        progress_ = now;
    } else {
        const std::uint64_t acknowledged_before = scans_.acknowledged();
        if (!is_first && welcome.session_id != session_id_ && acknowledged_before > 0) {
            lost_scans_ += acknowledged_before;
            return Error{Errc::kGone, fmt::format("session {} was deleted and created again while {} of its scans "
                                                  "were acknowledged; restart to fill the new one",
                                                  options_.hello.session, acknowledged_before)};
        }
        if (auto ok = scans_.rewind(welcome.last_durable_seq); !ok) {
            lost_scans_ += acknowledged_before - std::min(acknowledged_before, welcome.last_durable_seq);
            return ok.error();
        }
        if (scans_.acknowledged() > acknowledged_before) progress_ = now;
    }
    if (is_first) resumed_after_ = welcome.last_durable_seq;
    return std::nullopt;
}

std::optional<wire::LinkError> ClientProtocol::on_ack(const wire::Ack& ack, Time now) {
    if (ack.durable_seq > scans_.sent()) {
        return retry(Errc::kMalformed,
                     fmt::format("the server acknowledged scan {}, only {} were sent", ack.durable_seq, scans_.sent()));
    }
    if (ack.durable_seq > scans_.acknowledged()) {
        scans_.acknowledge(ack.durable_seq);
        progress_ = now;
    }
    applied_ = std::max(applied_, ack.applied_seq);
    link_->credit.durable(ack.durable_seq);
    link_->credit.set_credit(ack.credit_bytes);
    return std::nullopt;
}

// Sending -------------------------------------------------------------------------------------------------------------

bool ClientProtocol::append_next_frame(std::string& out, Time now) {
    if (!link_ || link_->said_goodbye) return false;
    const std::size_t before = out.size();
    if (const auto message = next_message(now)) {
        wire::encode(*message, out);
    } else if (!link_->welcomed || !append_about_scans(out, now)) {
        return false;
    }
    bytes_sent_ += out.size() - before;
    return true;
}

/// Returns the next message that does not concern scans.
std::optional<wire::Message> ClientProtocol::next_message(Time now) {
    if (!link_->said_hello) {
        link_->said_hello = true;
        return options_.hello;
    }
    if (!link_->welcomed) return std::nullopt;
    if (options_.first_sensor && !is_described(options_.first_sensor)) {
        link_->described[options_.first_sensor->id] = options_.first_sensor;
        return *options_.first_sensor;
    }
    if (!link_->pings_to_answer.empty()) {
        const wire::Pong pong{link_->pings_to_answer.front()};
        link_->pings_to_answer.erase(link_->pings_to_answer.begin());
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
    return requests_.next(); // before the scans: a caller waits for the reply
}

/// Appends a sensor description or a batch.
bool ClientProtocol::append_about_scans(std::string& out, Time now) {
    if (scans_.unsent_count() == 0) return false;
    const auto& sensor = scans_.sensor(scans_.sent() + 1);
    if (!is_described(sensor)) {
        link_->described[sensor->id] = sensor;
        wire::encode(*sensor, out);
        return true;
    }
    const std::size_t count = scans_that_fit();
    if (count == 0 || waits_for_others(count, now)) return false;
    append_batch(count, out);
    if (scans_.unsent_count() == 0) unsent_since_.reset();
    return true;
}

bool ClientProtocol::is_described(const std::shared_ptr<const Sensor>& sensor) const {
    const auto described = link_->described.find(sensor->id);
    return described != link_->described.end() && (described->second == sensor || *described->second == *sensor);
}

/// Returns whether to wait for more scans to share the batch with the `fitting` ones.
bool ClientProtocol::waits_for_others(std::size_t fitting, Time now) const {
    const std::size_t full = std::min<std::size_t>(link_->limits.scans_per_batch_max, options_.batch_scans_max);
    if (ended_ || fitting >= full) return false;
    if (options_.only_full_batches) return true;
    const bool is_all = fitting == scans_.unsent_count();
    return is_all && unsent_since_ && now < *unsent_since_ + options_.batch_delay;
}

/// Returns how many unsent scans go into the next batch: those whose sensor was described, within the credit, the
/// server's limits and batch_bytes_max. The first scan may exceed batch_bytes_max.
std::size_t ClientProtocol::scans_that_fit() {
    const wire::Limits& limits = link_->limits;
    const std::uint64_t frame_max = limits.frame_size_max + wire::kLengthPrefixBytes;
    const std::size_t count_max =
        std::min<std::uint64_t>({scans_.unsent_count(), limits.scans_per_batch_max, options_.batch_scans_max});
    std::size_t bytes = kBatchOverhead;
    for (std::size_t i = 0; i < count_max; ++i) {
        const std::uint64_t seq = scans_.sent() + 1 + i;
        const std::size_t beams = scans_.beams(seq);
        bytes += scans_.bytes_max(seq);
        if (beams > limits.beams_max || (i == 0 && bytes > frame_max)) {
            if (i > 0) return i;
            link_->cannot_send = {Errc::kTooLarge,
                                  fmt::format("scan {} has {} beams, the server takes at most {} and frames of "
                                              "at most {} bytes",
                                              seq, beams, limits.beams_max, limits.frame_size_max)};
            return 0;
        }
        const std::uint64_t bytes_max =
            std::min(link_->credit.available(),
                     i == 0 ? frame_max : std::min<std::uint64_t>(frame_max, options_.batch_bytes_max));
        if (!is_described(scans_.sensor(seq)) || bytes > bytes_max) return i;
    }
    return count_max;
}

/// Credit counts uncompressed bytes: what the server holds, not what is transmitted.
void ClientProtocol::append_batch(std::size_t count, std::string& out) {
    const std::size_t before = out.size();
    scans_.append_batch(scans_.sent() + 1, count, out);
    scans_.mark_sent(count);
    link_->credit.sent(scans_.sent(), out.size() - before);
    if (!compressor_ || !link_->zstd) return;
    const auto compressed = compressor_->compress(std::string_view(out).substr(before + wire::kLengthPrefixBytes));
    if (!compressed) return;
    out.resize(before);
    wire::encode(*compressed, out);
}

// Time ----------------------------------------------------------------------------------------------------------------

std::optional<wire::LinkError> ClientProtocol::check(Time now) const {
    if (!link_) return std::nullopt;
    if (link_->cannot_send) return give_up(*link_->cannot_send);
    if (!link_->welcomed && now >= link_->opened + options_.welcome_timeout) {
        return retry(Errc::kTimeout, fmt::format("the server did not answer the hello within {:g} s",
                                                 seconds_in(options_.welcome_timeout)));
    }
    if (link_->welcomed && now >= link_->heard + options_.silence_max) {
        return retry(Errc::kTimeout,
                     fmt::format("nothing came from the server for {:g} s", seconds_in(options_.silence_max)));
    }
    return std::nullopt;
}

ClientProtocol::Time ClientProtocol::ping_due() const {
    return std::max(link_->heard, link_->pinged.value_or(link_->heard)) + options_.ping_after;
}

ClientProtocol::Time ClientProtocol::deadline(Time now) const {
    if (!link_) return Time::max();
    if (!link_->welcomed) return link_->opened + options_.welcome_timeout;
    if (link_->said_goodbye) return link_->heard + options_.silence_max;
    const Time of_link = std::min(ping_due(), link_->heard + options_.silence_max);
    const Time batch_due = unsent_since_.value_or(now) + options_.batch_delay;
    return batch_due > now ? std::min(of_link, batch_due) : of_link;
}

void ClientProtocol::on_scans_added(std::uint64_t count, Time now) {
    assert(!ended_);
    const bool waited_for_none = scans_.acknowledged() + count == scans_.last();
    if (waited_for_none) progress_ = now;
    if (!unsent_since_) unsent_since_ = now;
}

std::optional<ClientProtocol::Time> ClientProtocol::stalled_since() const {
    if (resumed_after_ && scans_.all_acknowledged()) return std::nullopt;
    return progress_;
}

} // namespace scanloom::link
