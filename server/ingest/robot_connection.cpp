#include "server/ingest/robot_connection.hpp"

#include "server/ingest/join_session.hpp"

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

namespace scanloom::ingest {
namespace asio = boost::asio;
using Protocol = link::ServerProtocol;

RobotConnection::RobotConnection(net::LinkStream stream, LinkServices services,
                                 const link::ServerProtocolConfig& config)
    : stream_(std::move(stream)), services_(services), protocol_(config, Clock::now()), timer_(stream_.get_executor()),
      permission_(services.authenticator, protocol_,
                  [this](auth::Reason reason, const std::string& token, const std::string& session) {
                      services_.audit.note({auth::Port::kRobot, reason, address_, token, session});
                  }),
      unacknowledged_(services.counters) {
    boost::system::error_code ignored;
    const auto endpoint = stream_.socket().remote_endpoint(ignored);
    address_ = endpoint.address().to_string();
    peer_ = fmt::format("{}:{}", address_, endpoint.port());
    stream_.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
}

// Events --------------------------------------------------------------------------------------------------------------

/// Lets an event change the protocol's state, and performs the actions that follow.
template <class Event>
void RobotConnection::handle(Event event) {
    const auto perform_all = [this] {
        while (auto action = protocol_.next_action(Clock::now()))
            std::visit([this](auto& one) { perform(std::move(one)); }, *action);
    };
    try {
        event();
        perform_all();
    } catch (const std::exception& exception) {
        protocol_.fail({Errc::kInternal, fmt::format("this link failed unexpectedly: {}", exception.what())});
        perform_all();
    }
    start_read();
    watch_deadline();
}

/// Handles an event of another thread.
template <class Event>
void RobotConnection::post(Event event) {
    asio::post(stream_.get_executor(), [self = shared_from_this(), event = std::move(event)]() mutable {
        self->handle([&] { event(*self); });
    });
}

/// Makes a completion handler that runs on the stream's strand.
template <class Done>
auto RobotConnection::on_strand(Done done) {
    return asio::bind_executor(stream_.get_executor(), [self = shared_from_this(), done](auto... results) {
        self->handle([&] { done(*self, results...); });
    });
}

void RobotConnection::serve(std::function<void()> on_hello, std::function<void()> on_closed) {
    is_serving_ = true;
    on_hello_ = std::move(on_hello);
    on_closed_ = std::move(on_closed);
    post([](RobotConnection& self) { self.open(); });
}

void RobotConnection::turn_away(wire::LinkError why, std::function<void()> on_closed) {
    on_closed_ = std::move(on_closed);
    protocol_.turn_away(std::move(why), Clock::now());
    post([](RobotConnection& self) { self.open(); });
}

void RobotConnection::cut_off() {
    post([](RobotConnection& self) { self.stream_.close(); });
}

void RobotConnection::on_durable(std::uint64_t durable_seq, std::size_t bytes) {
    post([durable_seq, bytes](RobotConnection& self) { self.protocol_.on_durable(durable_seq, bytes); });
}

void RobotConnection::on_located(const sessions::Located& located) {
    const wire::Correction correction{located.T_map_odom,     located.revision,  located.inlier_ratio,
                                      located.position_sigma, located.yaw_sigma, located.state,
                                      located.mount_yaw_error};
    post([correction](RobotConnection& self) { self.protocol_.on_located(correction); });
}

void RobotConnection::on_failed(const Error& error) {
    post([error](RobotConnection& self) {
        if (self.session_) self.name_server_of(self.session_->info().name, error);
        self.protocol_.fail(error);
    });
}

/// Does the TLS handshake, if the port uses TLS.
void RobotConnection::open() {
    is_reading_ = true;
    stream_.async_handshake(net::LinkStream::Role::kServer,
                            on_strand([](RobotConnection& self, boost::system::error_code failed) {
                                self.is_reading_ = false;
                                if (!failed) return self.protocol_.on_open();
                                spdlog::debug("{}: TLS handshake: {}", self.peer_, failed.message());
                                const auto fault = net::client_fault_of(failed);
                                if (fault) self.services_.audit.note(auth::Port::kRobot, self.address_, *fault);
                                self.protocol_.on_handshake_failed();
                            }));
}

void RobotConnection::start_read() {
    const auto reading = protocol_.reading();
    if (is_reading_ || reading == Protocol::Reading::kNothing) return;
    is_reading_ = true;
    const auto room = protocol_.prepare();
    const auto into = asio::buffer(room.data(), room.size());
    auto done = on_strand([](RobotConnection& self, boost::system::error_code failed, std::size_t bytes) {
        self.is_reading_ = false;
        if (failed) return self.protocol_.on_read_failed();
        const std::chrono::duration<double> pause = self.protocol_.on_bytes(bytes, Clock::now());
        if (pause.count() > 0.0) self.services_.counters.held_back_seconds.Increment(pause.count());
    });
    if (reading == Protocol::Reading::kFrames) {
        stream_.async_read_some(into, std::move(done));
    } else {
        stream_.socket().async_read_some(into, std::move(done));
    }
}

/// Makes the timer expire at the protocol's deadline or before. A busy link only moves its deadline: the timer is set
/// again when it has expired.
void RobotConnection::watch_deadline() {
    if (protocol_.deadline() >= timer_expiry_) return;
    timer_expiry_ = protocol_.deadline();
    timer_.expires_at(timer_expiry_);
    timer_.async_wait(on_strand([](RobotConnection& self, boost::system::error_code replaced) {
        if (replaced) return;
        self.timer_expiry_ = Clock::time_point::max();
        self.protocol_.on_timer(Clock::now());
    }));
}

// Actions -------------------------------------------------------------------------------------------------------------

void RobotConnection::perform(Protocol::Join&& action) {
    if (on_hello_) on_hello_();
    robot_ = action.hello.robot;
    asio::co_spawn(stream_.get_executor(), join(shared_from_this(), std::move(action.hello)), asio::detached);
}

void RobotConnection::perform(Protocol::SubmitSensor&& action) {
    session_->submit(shared_from_this(), std::move(action.sensor), action.bytes);
}

void RobotConnection::perform(Protocol::SubmitScans&& action) {
    services_.counters.scans_received.Increment(static_cast<double>(action.scans.size()));
    unacknowledged_.add(action.scans.back().seq, action.scans.size(), action.read);
    session_->submit(shared_from_this(), std::move(action.scans), action.bytes);
}

void RobotConnection::perform(Protocol::AnswerRequest&& action) {
    auto done = [self = shared_from_this()](std::string frame, limits::Semaphore::Permit permit) {
        self->post([frame = std::move(frame), permit = std::move(permit)](RobotConnection& to) mutable {
            to.protocol_.on_reply(std::move(frame), std::move(permit));
        });
    };
    const auto refused = services_.requests.submit({session_, robot_index_, is_gone_}, action.request, std::move(done));
    if (refused) protocol_.on_request_refused(action.request, *refused);
}

void RobotConnection::perform(Protocol::RecordLimit&&) { permission_.record_limit(); }

void RobotConnection::perform(Protocol::Leave&&) {
    const auto& why = protocol_.ended_by();
    if (why) *is_gone_ = true;
    if (session_) session_->leave(shared_from_this());
    permission_.release();
    if (why) services_.counters.failed(why->code).Increment();
}

void RobotConnection::perform(Protocol::Send&& action) {
    if (action.durable_seq) unacknowledged_.acknowledge(*action.durable_seq, Clock::now());
    sending_ = std::move(action);
    asio::async_write(stream_, asio::buffer(sending_.bytes),
                      on_strand([](RobotConnection& self, boost::system::error_code failed, std::size_t) {
                          self.sending_ = {};
                          failed ? self.protocol_.on_write_failed() : self.protocol_.on_written();
                      }));
}

void RobotConnection::perform(Protocol::ShutDownSending&&) { stream_.shutdown_send(); }

void RobotConnection::perform(Protocol::Close&&) {
    timer_.cancel();
    *is_gone_ = true;
    stream_.close();
    if (is_serving_) log_end();
    if (on_closed_) std::exchange(on_closed_, nullptr)();
}

// The hello -----------------------------------------------------------------------------------------------------------

asio::awaitable<void> RobotConnection::join(std::shared_ptr<RobotConnection> self, wire::Hello hello) {
    Result<Protocol::Joined> joined = Error{Errc::kInternal, ""};
    try {
        joined = co_await self->enter(hello);
    } catch (const std::exception& exception) {
        joined = Error{Errc::kInternal, fmt::format("this link failed unexpectedly: {}", exception.what())};
    }
    self->handle([&] {
        if (joined) {
            self->protocol_.on_joined(std::move(*joined), Clock::now());
        } else {
            self->protocol_.on_not_joined(joined.error());
        }
    });
}

asio::awaitable<Result<Protocol::Joined>> RobotConnection::enter(const wire::Hello& hello) {
    const auto on_change = [weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->post([](RobotConnection& to) { to.permission_.apply(Clock::now()); });
    };
    if (auto ok = permission_.request(hello, Clock::now(), on_change); !ok) co_return ok.error();
    const auto creator = sessions::creator_of(*permission_.token());
    auto session = co_await session_for(hello, services_.sessions, creator, services_.blocking_executor);
    if (!session && session.error().code == Errc::kFull) permission_.record_limit();
    if (!session) {
        name_server_of(hello.session, session.error());
        co_return session.error();
    }
    const auto joined = co_await join_session(**session, hello, shared_from_this());
    if (!joined) {
        name_server_of(hello.session, joined.error());
        co_return joined.error();
    }
    session_ = std::move(*session);
    robot_index_ = joined->robot;
    log::info({hello.session, robot_, peer_}, "robot '{}' at {} joined session '{}' after scan {} ({})", robot_, peer_,
              hello.session, joined->last_durable_seq, hello.client);
    co_return Protocol::Joined{sessions::tag_of(session_->info()), joined->last_durable_seq, joined->sensors};
}

/// Names the server to which the robot connects next, if another one has its session.
void RobotConnection::name_server_of(const std::string& session, const Error& why) {
    if (why.code != Errc::kNotOwner) return;
    auto server = services_.sessions.successor(session);
    if (!server) server = services_.sessions.owner(session);
    if (server) protocol_.set_owner(server->robots);
}

// Logs ----------------------------------------------------------------------------------------------------------------

void RobotConnection::log_end() const {
    const std::string who = robot_.empty() ? fmt::format("a link from {} without a valid hello ended:", peer_)
                                           : fmt::format("robot '{}' at {} left:", robot_, peer_);
    const auto& why = protocol_.ended_by();
    const std::string_view how = why ? std::string_view(why->message) : "goodbye";
    const log::Context about{session_ ? std::string_view(session_->info().name) : "", robot_, peer_};
    if (permission_.token()) return log::info(about, "{} {}", who, how);
    const auto not_logged = services_.audit.admit_log_line();
    if (!not_logged) return;
    const auto others =
        *not_logged > 0 ? fmt::format(" ({} others were refused since the last line like this)", *not_logged) : "";
    log::info(about, "{} {}{}", who, how, others);
}

} // namespace scanloom::ingest
