#include "common/link/server_protocol.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/compression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace scanloom::link {
namespace {

constexpr std::size_t kReadBytes = std::size_t{64} << 10;

/// Bound on the accepted requests whose replies have not been taken for writing.
constexpr std::size_t kRequestsUnderWayMax = 4;

/// Bound on the bytes of pongs and refusals that a robot has not read.
constexpr std::size_t kSmallAnswerBytesMax = std::size_t{64} << 10;

/// Bound on the bytes of sensor descriptions that are not durable yet, in addition to the credit for scans: twice the
/// size of the descriptions of 64 sensors with 4096 explicit angles each.
constexpr std::size_t kDescriptionBytesMax = std::size_t{4} << 20;

constexpr ServerProtocol::Duration kCorrectionPeriod =
    ServerProtocol::Duration(std::chrono::seconds(1)) / ServerProtocol::kCorrectionsPerSecond;

double seconds_of(ServerProtocol::Time time) { return std::chrono::duration<double>(time.time_since_epoch()).count(); }

std::string in_http(std::string_view sentence) {
    return fmt::format("HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain; charset=utf-8\r\n"
                       "Content-Length: {}\r\nConnection: close\r\n\r\n{}\n",
                       sentence.size() + 1, sentence);
}

} // namespace

bool is_retryable(Errc code) noexcept {
    return code == Errc::kTimeout || code == Errc::kStoreFailed || code == Errc::kShuttingDown ||
           code == Errc::kOutOfOrder || code == Errc::kOverloaded || code == Errc::kDamaged || code == Errc::kNotOwner;
}

ServerProtocol::ServerProtocol(const ServerProtocolConfig& config, Time now)
    : config_(config), limits_(seconds_of(now)), deadline_(now + config.hello_deadline), read_(now) {}

void ServerProtocol::turn_away(wire::LinkError why, Time now) {
    turned_away_ = std::move(why);
    deadline_ = now + config_.farewell_deadline;
}

// The connection ------------------------------------------------------------------------------------------------------

void ServerProtocol::on_open() {
    if (state_ != State::kConnecting) return; // the deadline passed before
    state_ = State::kHello;
    if (turned_away_) fail(turned_away_->error);
}

void ServerProtocol::on_handshake_failed() { fail({Errc::kUnreachable, "the TLS handshake failed"}); }

std::span<std::byte> ServerProtocol::prepare() {
    const std::size_t bytes = reading() == Reading::kFrames ? limits_.read_max(kReadBytes) : kReadBytes;
    return decoder_.prepare(bytes).first(bytes);
}

ServerProtocol::Duration ServerProtocol::on_bytes(std::size_t count, Time now) {
    if (reading() != Reading::kFrames) return {}; // the link has ended since the read began
    decoder_.commit(count);
    may_hold_frame_ = true;
    read_ = now;
    const double pause = limits_.pause_after(count, seconds_of(now));
    if (pause <= 0.0) return {};
    const auto duration = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(pause));
    resumes_ = now + duration;
    if (deadline_ != Time::max()) deadline_ += duration; // the pause is not the robot's fault
    return duration;
}

void ServerProtocol::on_read_failed() {
    if (state_ == State::kHangingUp) state_ = State::kClosed;
    fail({Errc::kUnreachable, "the robot closed the connection"});
}

void ServerProtocol::on_write_failed() {
    is_writing_ = false;
    queue_ = {};
    queue_.close();
}

void ServerProtocol::on_timer(Time now) {
    if (resumes_ && now >= *resumes_) resumes_.reset();
    if (now < deadline_) return;
    if (state_ == State::kFarewell || state_ == State::kHangingUp) state_ = State::kClosed;
    fail({Errc::kTimeout,
          is_welcome_ ? "nothing was received for too long; send pings" : "no hello was received in time"});
}

ServerProtocol::Reading ServerProtocol::reading() const noexcept {
    if (state_ == State::kHangingUp) return Reading::kUntilEnd;
    const bool takes_frames = state_ == State::kHello || state_ == State::kJoined;
    return takes_frames && !ended_by_ && !is_paused() && !may_hold_frame_ ? Reading::kFrames : Reading::kNothing;
}

ServerProtocol::Time ServerProtocol::deadline() const noexcept {
    const Time deadline = can_send_correction() ? std::min(correction_due_, deadline_) : deadline_;
    return resumes_ ? std::min(*resumes_, deadline) : deadline;
}

bool ServerProtocol::can_send_correction() const noexcept {
    return correction_ && state_ == State::kJoined && !is_writing_;
}

// The session and the owner -------------------------------------------------------------------------------------------

void ServerProtocol::set_limits(LinkLimits limits, Time now) { limits_.set_limits(std::move(limits), seconds_of(now)); }

void ServerProtocol::on_joined(Joined joined, Time now) {
    state_ = State::kJoined;
    is_welcome_ = true;
    deadline_ = now + config_.idle_deadline;
    limits_.set_sensors(std::move(joined.sensors));
    decoder_.set_frame_bytes_max(wire::kFrameBytesMax);
    const wire::Limits limits{static_cast<std::uint32_t>(wire::kFrameBytesMax), static_cast<std::uint32_t>(kBeamsMax),
                              static_cast<std::uint32_t>(kScansPerBatchMax)};
    queue_.add(
        wire::Welcome{std::move(joined.session_id), joined.last_durable_seq, limits, config_.credit_bytes, true});
}

void ServerProtocol::on_not_joined(const Error& why) {
    state_ = State::kHello;
    fail(why);
}

void ServerProtocol::on_durable(std::uint64_t durable_seq, std::size_t bytes) {
    under_way_ -= std::min(bytes, under_way_);
    described_ = std::min(described_, under_way_);
    queue_.acknowledge({durable_seq, durable_seq, config_.credit_bytes});
}

void ServerProtocol::on_reply(std::string frame, std::shared_ptr<const void> kept) {
    --asked_;
    queue_.add_reply(std::move(frame), std::move(kept));
}

void ServerProtocol::on_request_refused(const Request& request, const Error& why) {
    --asked_;
    queue_.add(refusal_of(request, why));
}

void ServerProtocol::fail(const Error& why) {
    if (!ended_by_ && state_ < State::kFarewell) ended_by_ = why;
}

// Actions -------------------------------------------------------------------------------------------------------------

std::optional<ServerProtocol::Action> ServerProtocol::next_action(Time now) {
    if (auto action = next_of_frames(now)) return action;
    if (std::exchange(is_over_limit_, false)) return RecordLimit{};
    const bool is_settled = state_ == State::kSettling && under_way_ == 0 && asked_ == 0;
    const bool has_failed = ended_by_ && state_ != State::kJoining; // joining completes first
    if (state_ < State::kFarewell && (is_settled || has_failed)) begin_farewell(now);
    if (std::exchange(leaves_, false)) return Leave{};
    if (can_send_correction() && now >= correction_due_) {
        queue_.add(*std::exchange(correction_, std::nullopt));
        correction_due_ = now + kCorrectionPeriod;
    }
    if (state_ < State::kHangingUp && !is_writing_) {
        if (auto piece = queue_.next()) {
            is_writing_ = true;
            return std::move(*piece);
        }
    }
    return next_of_farewell(now);
}

/// Decodes frames until one needs an action.
std::optional<ServerProtocol::Action> ServerProtocol::next_of_frames(Time now) {
    while ((state_ == State::kHello || state_ == State::kJoined) && may_hold_frame_ && !ended_by_ && !is_paused()) {
        const auto body = decoder_.next();
        if (!body) {
            Error error = body.error();
            if (is_welcome_ && error.code == Errc::kTooLarge) error.message += "; send fewer scans per batch";
            fail(error);
            break;
        }
        may_hold_frame_ = body->has_value();
        if (!*body) break;
        auto action = take_frame(**body, now);
        if (!action) fail(action.error());
        if (action && *action) return std::move(**action);
    }
    return std::nullopt;
}

Result<std::optional<ServerProtocol::Action>> ServerProtocol::take_frame(std::string_view body, Time now) {
    auto message = wire::decode(body);
    if (!message) return message.error();
    if (state_ == State::kHello) return take_hello(std::move(*message));
    std::size_t frame_bytes = wire::kLengthPrefixBytes + body.size();
    if (const auto* compressed = std::get_if<wire::CompressedScanBatch>(&*message)) {
        auto batch = wire::decompress(*compressed);
        if (!batch) return batch.error();
        frame_bytes = wire::bytes_under_way(*compressed);
        *message = std::move(*batch);
    }
    if (auto ok = limits_.check(*message); !ok) {
        is_over_limit_ = true;
        return ok.error();
    }
    deadline_ = now + config_.idle_deadline;
    return take_message(std::move(*message), frame_bytes);
}

Result<std::optional<ServerProtocol::Action>> ServerProtocol::take_hello(wire::Message message) {
    auto* hello = std::get_if<wire::Hello>(&message);
    if (hello == nullptr) {
        return Error{Errc::kMalformed,
                     fmt::format("the first frame is a {}; a hello is expected", wire::name_of(message))};
    }
    state_ = State::kJoining;
    deadline_ = Time::max(); // the next wait is for the disk, not for the robot
    return Join{std::move(*hello)};
}

Result<std::optional<ServerProtocol::Action>> ServerProtocol::take_message(wire::Message message,
                                                                           std::size_t frame_bytes) {
    if (auto* sensor = std::get_if<Sensor>(&message)) {
        if (auto ok = charge_description(frame_bytes); !ok) return ok.error();
        return SubmitSensor{std::move(*sensor), frame_bytes};
    }
    if (auto* batch = std::get_if<wire::ScanBatch>(&message)) {
        if (auto ok = charge_batch(frame_bytes); !ok) return ok.error();
        return SubmitScans{std::move(batch->scans), frame_bytes, read_};
    }
    if (const auto* ping = std::get_if<wire::Ping>(&message)) {
        if (auto ok = check_small_answers(); !ok) return ok.error();
        queue_.add(wire::Pong{ping->nonce});
        return std::nullopt;
    }
    if (std::holds_alternative<wire::Pong>(message)) return std::nullopt;
    if (std::holds_alternative<wire::Goodbye>(message)) {
        state_ = State::kSettling;
        deadline_ = Time::max(); // the next wait is not for the robot
        return std::nullopt;
    }
    if (auto request = as_request(std::move(message))) return take_request(std::move(*request));
    return Error{Errc::kMalformed,
                 fmt::format("a {} frame is not for the server; after the hello it takes sensor_description, "
                             "scan_batch, requests, ping and goodbye",
                             // NOLINTNEXTLINE(bugprone-use-after-move): as_request() leaves other messages unchanged
                             wire::name_of(message))};
}

/// Refuses a request at once if too many are under way. The link continues.
Result<std::optional<ServerProtocol::Action>> ServerProtocol::take_request(Request request) {
    if (auto ok = check_small_answers(); !ok) return ok.error();
    const std::size_t under_way = asked_ + queue_.replies_waiting();
    if (under_way < kRequestsUnderWayMax) {
        ++asked_;
        return AnswerRequest{std::move(request)};
    }
    queue_.add(refusal_of(
        request,
        {Errc::kOverloaded,
         fmt::format(
             "{} requests are under way, the most that a link may have; read their replies before the next request",
             under_way)}));
    return std::nullopt;
}

// Credit --------------------------------------------------------------------------------------------------------------

Result<> ServerProtocol::check_small_answers() const {
    if (queue_.waiting() <= kSmallAnswerBytesMax) return {};
    return Error{Errc::kCreditExceeded,
                 fmt::format("{} bytes of pongs and refusals wait to be read, at most {} may; read them before the "
                             "next ping or request",
                             queue_.waiting(), kSmallAnswerBytesMax)};
}

Result<> ServerProtocol::charge_batch(std::size_t bytes) {
    under_way_ += bytes;
    if (under_way_ <= config_.credit_bytes + described_) return {};
    return Error{Errc::kCreditExceeded,
                 fmt::format("{} bytes of scan batches are under way, the credit is {}; wait for acks",
                             under_way_ - described_, config_.credit_bytes)};
}

/// Sensor descriptions need no credit, but the bytes that wait for the disk must be bounded.
Result<> ServerProtocol::charge_description(std::size_t bytes) {
    under_way_ += bytes;
    described_ += bytes;
    if (described_ <= config_.credit_bytes + kDescriptionBytesMax) return {};
    return Error{Errc::kCreditExceeded,
                 fmt::format("{} bytes of sensor descriptions are under way, at most {} are allowed; describe a "
                             "sensor only when it has changed",
                             described_, config_.credit_bytes + kDescriptionBytesMax)};
}

// The end -------------------------------------------------------------------------------------------------------------

/// Ends the link. The robot receives the reason, unless it closed the connection or there is no encryption yet.
void ServerProtocol::begin_farewell(Time now) {
    const bool can_send = state_ != State::kConnecting;
    const bool has_left = can_send && ended_by_ && ended_by_->code == Errc::kUnreachable;
    leaves_ = !turned_away_;
    deadline_ = now + config_.farewell_deadline;
    resumes_.reset();
    if (can_send && ended_by_ && !has_left) queue_last_message();
    queue_.close();
    state_ = has_left ? State::kClosed : State::kFarewell;
}

void ServerProtocol::queue_last_message() {
    if (!is_welcome_ && decoder_.holds_http()) {
        queue_.add_bytes(in_http(ended_by_->message)); // an HTTP client cannot read frames
    } else {
        queue_.add(turned_away_.value_or(wire::LinkError{*ended_by_, is_retryable(ended_by_->code), owner_}));
    }
}

/// Shuts down sending once all is written, and waits for the robot to close the connection. Closing it at once, with
/// the robot's bytes unread, would reset the connection and lose the last frame.
std::optional<ServerProtocol::Action> ServerProtocol::next_of_farewell(Time now) {
    if (state_ == State::kFarewell && !is_writing_) {
        state_ = State::kHangingUp;
        deadline_ = now + config_.farewell_deadline;
        return ShutDownSending{};
    }
    if (state_ != State::kClosed || is_closed_) return std::nullopt;
    is_closed_ = true;
    deadline_ = Time::max();
    return Close{};
}

} // namespace scanloom::link
