#include "server/ingest/robot_link.hpp"

#include "common/net/await_tuple.hpp"
#include "common/wire/compression.hpp"
#include "server/ingest/entrance.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace scanloom::ingest {
namespace asio = boost::asio;
namespace {

constexpr std::size_t kReadBytes = std::size_t{64} << 10;

/// Bound on a link's accepted requests whose replies have not been taken for writing.
constexpr std::size_t kRequestsUnderWayMax = 4;

Error closed_by_robot() { return {Errc::kUnreachable, "the robot closed the connection"}; }

wire::LinkError in_words(const Error& error) { return {error, is_retryable(error.code)}; }

} // namespace

bool is_retryable(Errc code) noexcept {
    return code == Errc::kTimeout || code == Errc::kStoreFailed || code == Errc::kShuttingDown ||
           code == Errc::kOutOfOrder || code == Errc::kOverloaded || code == Errc::kDamaged;
}

RobotLink::RobotLink(net::LinkStream stream, LinkServices services, const LinkConfig& config)
    : stream_(std::move(stream)), services_(services), config_(config), allowance_(guard::steady_seconds()),
      outbox_([this] { writer_.start(shared_from_this()); }),
      writer_(stream_, outbox_,
              [this](std::uint64_t seq) { dialogue_.acknowledged(seq, std::chrono::steady_clock::now()); }),
      dialogue_(services.counters, outbox_, config.credit_bytes), held_back_(stream_.get_executor()),
      settled_(stream_.get_executor(), std::chrono::steady_clock::time_point::max()),
      deadline_timer_(stream_.get_executor()) {
    boost::system::error_code ignored;
    const auto endpoint = stream_.socket().remote_endpoint(ignored);
    address_ = endpoint.address().to_string();
    peer_ = fmt::format("{}:{}", address_, endpoint.port());
    stream_.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
}

asio::awaitable<void> RobotLink::run() {
    const auto self = shared_from_this();
    expect_something_within(config_.hello_deadline);
    start_watch();
    Result<> served;
    try {
        served = co_await serve();
    } catch (const std::exception& exception) {
        served = Error{Errc::kInternal, fmt::format("this link failed unexpectedly: {}", exception.what())};
    }
    if (!served) *is_gone_ = true;
    if (dialogue_.is_welcome()) dialogue_.session()->leave(self);
    const bool was_let_in = pass_ != nullptr;
    pass_.reset();
    if (ended_by_) served = *ended_by_;
    if (!served) services_.counters.failed(served.error().code).Increment();
    if (served) co_await part();
    if (!served && served.error().code != Errc::kUnreachable) co_await farewell(in_words(served.error()));
    hang_up();
    tell_end(served ? "goodbye" : served.error().message, was_let_in);
}

void RobotLink::cut_off() {
    asio::post(stream_.get_executor(), [self = shared_from_this()] { self->stream_.close(); });
}

asio::awaitable<void> RobotLink::turn_away(wire::LinkError why) {
    expect_something_within(config_.farewell_deadline);
    start_watch();
    const bool can_be_told = co_await shake_hands();
    if (can_be_told) co_await farewell(std::move(why));
    hang_up();
}

/// Does the TLS handshake, if the port uses TLS.
/// @return whether frames can be read and written
asio::awaitable<bool> RobotLink::shake_hands() {
    const auto [failed] = co_await stream_.async_handshake(
        net::LinkStream::Role::kServer, asio::bind_cancellation_slot(stop_reading_.slot(), kAwaitTuple));
    if (!failed) co_return true;
    spdlog::debug("{}: TLS handshake: {}", peer_, failed.message());
    if (const auto fault = net::client_fault_of(failed)) services_.audit.note(access::Port::kRobot, address_, *fault);
    co_await let_hang_up();
    co_return false;
}

/// Runs the whole link, step by step.
asio::awaitable<Result<>> RobotLink::serve() {
    const bool is_open = co_await shake_hands();
    if (!is_open) co_return Error{Errc::kUnreachable, "the TLS handshake failed"};
    auto first = co_await receive();
    if (!first) co_return first.error();
    auto* hello = std::get_if<wire::Hello>(&*first);
    if (hello == nullptr) {
        co_return Error{Errc::kMalformed,
                        fmt::format("the first frame is a {}; a hello is expected", wire::name_of(*first))};
    }
    if (greeted_) greeted_();
    deadline_ = std::chrono::steady_clock::time_point::max(); // the next wait is for our disk, not for the robot
    if (auto entered = co_await enter(std::move(*hello)); !entered) co_return entered.error();
    while (!dialogue_.said_goodbye()) {
        expect_something_within(config_.idle_deadline);
        auto message = co_await receive();
        if (!message) co_return message.error();
        if (auto handled = handle(std::move(*message)); !handled) co_return handled.error();
    }
    co_return co_await settle();
}

/// Waits after a goodbye until all submitted scans are acknowledged and all requests answered. There is no deadline,
/// because the wait does not depend on the robot.
asio::awaitable<Result<>> RobotLink::settle() {
    deadline_ = std::chrono::steady_clock::time_point::max();
    while ((dialogue_.has_under_way() || asked_ > 0) && !ended_by_) co_await settled_.async_wait(kAwaitTuple);
    if (ended_by_) co_return *ended_by_;
    co_return Result<>();
}

/// Authenticates the robot before the session is looked up, so that a refused client does not learn which sessions
/// exist.
Result<> RobotLink::let_in(const wire::Hello& hello) {
    auto pass = services_.gate.let_drive(hello.token, hello.session, hello.robot);
    if (!pass) {
        const auto& why = pass.error();
        note_refusal(why.reason, why.token, hello.session);
        return prefixed("hello.token: ", why.error);
    }
    pass_ = std::move(*pass);
    look_at_pass();
    pass_->when_changed([weak = weak_from_this()] {
        const auto self = weak.lock();
        if (self) asio::post(self->stream_.get_executor(), [self] { self->look_at_pass(); });
    });
    return {};
}

/// Applies the token of the pass, which may have changed. Ends the link if the pass is no longer valid.
void RobotLink::look_at_pass() {
    if (!pass_) return;
    if (auto token = pass_->token()) {
        allowance_.set_token(std::move(token), guard::steady_seconds());
        return;
    }
    note_refusal(access::Reason::kRevoked, allowance_.token().name, pass_->session());
    end({Errc::kUnauthorized,
         fmt::format("the token '{}' does not allow this any more; ask whoever runs this server for another",
                     allowance_.token().name)});
}

void RobotLink::note_refusal(access::Reason reason, const std::string& token, const std::string& session) const {
    services_.audit.note({access::Port::kRobot, reason, address_, token, session});
}

asio::awaitable<Result<>> RobotLink::enter(wire::Hello hello) {
    robot_ = hello.robot;
    if (auto in = let_in(hello); !in) co_return in.error();
    const auto maker = session::maker_of(allowance_.token());
    auto session = co_await session_for(hello, services_.sessions, maker, services_.may_wait);
    if (!session && session.error().code == Errc::kFull)
        note_refusal(access::Reason::kLimit, allowance_.token().name, hello.session);
    if (!session) co_return session.error();
    const auto joined = co_await join(**session, hello, shared_from_this());
    if (!joined) co_return joined.error();
    allowance_.set_sensors(joined->sensors);
    decoder_.set_frame_bytes_max(wire::kFrameBytesMax);
    log::info({hello.session, robot_, peer_}, "robot '{}' at {} joined session '{}' after scan {} ({})", robot_, peer_,
              hello.session, joined->last_durable_seq, hello.client);
    dialogue_.welcome(std::move(*session), *joined);
    co_return Result<>();
}

asio::awaitable<Result<wire::Message>> RobotLink::receive() {
    for (;;) {
        if (ended_by_) co_return *ended_by_;
        const auto body = decoder_.next();
        if (!body) {
            Error error = body.error();
            if (dialogue_.is_welcome() && error.code == Errc::kTooLarge) error.message += "; send fewer scans a batch";
            co_return error;
        }
        if (*body) {
            frame_bytes_ = wire::kLengthPrefixBytes + (*body)->size();
            co_return wire::decode(**body);
        }
        const auto room = decoder_.prepare(allowance_.read_max(kReadBytes));
        const auto [error, bytes] = co_await stream_.async_read_some(
            asio::buffer(room.data(), room.size()), asio::bind_cancellation_slot(stop_reading_.slot(), kAwaitTuple));
        if (error) {
            if (ended_by_) co_return *ended_by_;
            co_return closed_by_robot();
        }
        decoder_.commit(bytes);
        read_ = std::chrono::steady_clock::now();
        const double pause = allowance_.pause_after(bytes, guard::steady_seconds());
        if (pause > 0.0) co_await hold_back(pause);
    }
}

/// Pauses reading, so that the buffers on the way from the robot fill up and the robot has to wait. The pause is not
/// the robot's fault, so its deadline moves by the same time.
asio::awaitable<void> RobotLink::hold_back(double seconds) {
    if (ended_by_) co_return;
    const auto pause =
        std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
    services_.counters.held_back_seconds.Increment(seconds);
    if (deadline_ != std::chrono::steady_clock::time_point::max()) deadline_ += pause;
    held_back_.expires_after(pause);
    co_await held_back_.async_wait(kAwaitTuple);
}

Result<> RobotLink::handle(wire::Message message) {
    if (const auto* compressed = std::get_if<wire::CompressedScanBatch>(&message)) {
        auto batch = wire::decompress(*compressed);
        if (!batch) return batch.error();
        frame_bytes_ = wire::bytes_under_way(*compressed);
        message = std::move(*batch);
    }
    if (auto ok = allowance_.check(message); !ok) return over_limit(ok.error());
    if (auto request = as_request(std::move(message))) return ask(std::move(*request));
    // NOLINTNEXTLINE(bugprone-use-after-move): as_request() leaves a message that is not a request unchanged
    return dialogue_.handle(std::move(message), frame_bytes_, read_, shared_from_this());
}

/// Passes a request to the desk. A request that cannot be accepted now is refused at once; the link continues.
Result<> RobotLink::ask(Request request) {
    if (auto ok = dialogue_.check_small_answers(); !ok) return ok;
    const std::size_t under_way = asked_ + outbox_.answers_waiting();
    if (under_way >= kRequestsUnderWayMax) {
        const Error why{Errc::kOverloaded, fmt::format("{} requests are under way, the most a link may have; read "
                                                       "their replies before the next",
                                                       under_way)};
        outbox_.send(refusal_of(request, why));
        return {};
    }
    auto done = [self = shared_from_this()](std::string frame, std::shared_ptr<const void> slot) {
        asio::post(self->stream_.get_executor(), [self, frame = std::move(frame), slot = std::move(slot)]() mutable {
            self->answer(std::move(frame), std::move(slot));
        });
    };
    const auto refused =
        services_.desk.ask({dialogue_.session(), dialogue_.robot(), is_gone_}, request, std::move(done));
    if (refused) {
        outbox_.send(refusal_of(request, *refused));
    } else {
        ++asked_;
    }
    return {};
}

void RobotLink::answer(std::string frame, std::shared_ptr<const void> slot) {
    --asked_;
    outbox_.answer(std::move(frame), std::move(slot));
    settled_.cancel();
}

/// Records a refusal because of a token limit in the audit log. Returns the error for the robot.
Error RobotLink::over_limit(Error error) const {
    note_refusal(access::Reason::kLimit, allowance_.token().name, pass_->session());
    return error;
}

void RobotLink::on_durable(std::uint64_t durable_seq, std::size_t bytes) {
    asio::post(stream_.get_executor(), [self = shared_from_this(), durable_seq, bytes] {
        self->dialogue_.on_durable(durable_seq, bytes);
        if (!self->dialogue_.has_under_way()) self->settled_.cancel();
    });
}

void RobotLink::on_failed(const Error& error) {
    asio::post(stream_.get_executor(), [self = shared_from_this(), error] { self->end(error); });
}

} // namespace scanloom::ingest
