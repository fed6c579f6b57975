#include "tests/fault/simulation/server.hpp"

#include "common/link/server_protocol.hpp"
#include "server/ingest/join_session.hpp"
#include "server/ingest/link_permission.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>
#include <utility>

namespace scanloom::simulation {

namespace asio = boost::asio;
using namespace std::chrono_literals;

/// Connects a link::ServerProtocol to the simulated network and the sessions, as ingest::RobotConnection does for a
/// socket.
class Server::Link final : public sessions::RobotListener, public std::enable_shared_from_this<Link> {
public:
    using Id = ingest::ConnectionLimits::Id;

    Link(Server& server, std::shared_ptr<Connection> connection, Id id)
        : server_(server), connection_(std::move(connection)), id_(id), strand_(server.machine_->executor()),
          protocol_({.idle_deadline = server.options_.idle_deadline, .credit_bytes = server.options_.credit_bytes},
                    server.world_.now()),
          permission_(server.authenticator_, protocol_, [this](auth::Reason reason, const auto&, const auto&) {
              server_.tokens_.count(auth::name_of(reason));
          }) {}

    /// Sends the robot the reason instead of serving it. Call it before start().
    void turn_away(wire::LinkError why) {
        turned_away_ = true;
        protocol_.turn_away(std::move(why), server_.world_.now());
    }

    void start() {
        const std::weak_ptr<Link> weak = weak_from_this();
        connection_->listen(Side::kServer, {[weak](std::string_view bytes) {
                                                if (const auto self = weak.lock()) self->on_bytes(bytes);
                                            },
                                            [weak] {
                                                if (const auto self = weak.lock()) self->on_end();
                                            }});
        handle([this] { protocol_.on_open(); });
    }

    void on_durable(std::uint64_t durable_seq, std::size_t bytes) override {
        later([durable_seq, bytes](Link& self) { self.protocol_.on_durable(durable_seq, bytes); });
    }
    void on_failed(const Error& error) override {
        later([error](Link& self) { self.protocol_.fail(error); });
    }

    /// Closes the connection without an Error frame.
    void cut_off() {
        server_.tokens_.count("without_hello");
        connection_->close(Side::kServer);
        received_.clear();
        on_end();
    }

    [[nodiscard]] Id id() const { return id_; }
    [[nodiscard]] bool is_closed() const { return closed_; }
    [[nodiscard]] bool is_waiting() const { return !hello_ && !turned_away_ && !has_ended_; }
    [[nodiscard]] bool is_served() const { return hello_.has_value(); }
    /// Returns the hello of a link that counts as one of its token's connections, else null.
    [[nodiscard]] const wire::Hello* granted() const { return granted_ ? &*hello_ : nullptr; }

    /// The program has ended.
    void vanish() {
        if (!closed_) connection_->vanish(Side::kServer);
        closed_ = true;
    }

private:
    using Protocol = link::ServerProtocol;

    template <class Event>
    void handle(Event event) {
        if (closed_) return;
        event();
        do {
            while (auto action = protocol_.next_action(server_.world_.now()))
                std::visit([this](auto& one) { perform(std::move(one)); }, *action);
        } while (read());
        watch_deadline();
    }

    template <class Event>
    void later(Event event) {
        asio::post(strand_, [self = shared_from_this(), event] { self->handle([&] { event(*self); }); });
    }

    void on_bytes(std::string_view bytes) {
        handle([&] { received_ += bytes; });
    }
    void on_end() {
        handle([&] { has_ended_ = true; });
    }

    /// Does the read that the protocol asks for, if something has arrived.
    bool read() {
        if (protocol_.reading() == Protocol::Reading::kNothing || (received_.empty() && !has_ended_)) return false;
        if (received_.empty()) {
            protocol_.on_read_failed();
            return true;
        }
        const auto room = protocol_.prepare();
        const std::size_t count = std::min(room.size(), received_.size());
        std::ranges::copy(std::as_bytes(std::span(received_).first(count)), room.begin());
        received_.erase(0, count);
        protocol_.on_bytes(count, server_.world_.now());
        if (!granted_) return true;
        bytes_read_ += count;
        server_.tokens_.check_bytes(*hello_, bytes_read_, server_.world_.now() - *granted_);
        return true;
    }

    void watch_deadline() {
        const Time due = protocol_.deadline();
        if (closed_ || due >= timer_expiry_) return;
        timer_expiry_ = due;
        server_.world_.at(due, [weak = weak_from_this(), due] {
            const auto self = weak.lock();
            if (!self || self->closed_ || self->timer_expiry_ != due) return;
            self->timer_expiry_ = Time::max();
            self->handle([&] { self->protocol_.on_timer(due); });
        });
    }

    void perform(Protocol::Join&& action) {
        server_.limits_.on_hello(id_);
        hello_ = std::move(action.hello);
        asio::co_spawn(strand_, join(shared_from_this()), asio::detached);
    }
    void perform(Protocol::SubmitSensor&& action) {
        session_->submit(shared_from_this(), std::move(action.sensor), action.bytes);
    }
    void perform(Protocol::SubmitScans&& action) {
        server_.tokens_.check_scans(*hello_, action.scans);
        session_->submit(shared_from_this(), std::move(action.scans), action.bytes);
    }
    void perform(Protocol::AnswerRequest&& action) {
        protocol_.on_request_refused(action.request, {Errc::kOverloaded, "requests are not simulated"});
    }
    void perform(Protocol::RecordLimit&&) { permission_.record_limit(); }
    void perform(Protocol::Leave&&) {
        if (protocol_.ended_by()) server_.world_.note(protocol_.ended_by()->message);
        if (session_) session_->leave(shared_from_this());
        permission_.release();
        granted_.reset();
    }
    void perform(Protocol::Send&& action) {
        if (action.durable_seq) server_.promise_(hello_->robot, *action.durable_seq);
        connection_->send(Side::kServer, std::move(action.bytes));
        later([](Link& self) { self.protocol_.on_written(); });
    }
    /// A side of the simulated connection that has closed it receives no more data.
    void perform(Protocol::ShutDownSending&&) {
        connection_->close(Side::kServer);
        received_.clear();
        has_ended_ = true;
    }
    void perform(Protocol::Close&&) {
        connection_->close(Side::kServer);
        closed_ = true;
        server_.limits_.on_closed(id_);
    }

    static asio::awaitable<void> join(std::shared_ptr<Link> self) {
        auto joined = co_await self->enter();
        self->handle([&] {
            if (joined) {
                self->server_.promise_(self->hello_->robot, joined->last_durable_seq);
                self->protocol_.on_joined(std::move(*joined), self->server_.world_.now());
            } else {
                self->protocol_.on_not_joined(joined.error());
            }
        });
        if (self->closed_ && self->session_) self->session_->leave(self);
    }

    asio::awaitable<Result<Protocol::Joined>> enter() {
        const auto on_change = [weak = weak_from_this()] {
            if (const auto self = weak.lock())
                self->later([](Link& to) { to.permission_.apply(to.server_.world_.now()); });
        };
        if (auto ok = permission_.request(*hello_, server_.world_.now(), on_change); !ok) co_return ok.error();
        granted_ = server_.world_.now();
        server_.tokens_.check_connections(*hello_, server_.connected_with(hello_->token));
        const auto creator = sessions::creator_of(*permission_.token());
        auto session = co_await ingest::session_for(*hello_, server_.sessions(), creator, server_.blocking_executor_);
        if (!session && session.error().code == Errc::kFull) permission_.record_limit();
        if (!session) co_return session.error();
        auto joined = co_await ingest::join_session(**session, *hello_, shared_from_this());
        if (!joined) co_return joined.error();
        session_ = std::move(*session);
        co_return Protocol::Joined{sessions::tag_of(session_->info()), joined->last_durable_seq, joined->sensors};
    }

    Server& server_;
    std::shared_ptr<Connection> connection_;
    const Id id_;
    asio::strand<asio::any_io_executor> strand_;
    Protocol protocol_;
    ingest::LinkPermission permission_;
    bool turned_away_ = false;
    std::optional<wire::Hello> hello_;
    std::optional<Time> granted_;                // when the robot was permitted, until it leaves
    std::size_t bytes_read_ = 0;                 // since then
    std::shared_ptr<sessions::Session> session_; // joined
    std::string received_;                       // not read yet
    bool has_ended_ = false;                     // no more data arrives
    Time timer_expiry_ = Time::max();
    bool closed_ = false;
};

Server::Server(World& world, Disk& disk, const ServerOptions& options, Tokens& tokens, Promise promise)
    : world_(world), disk_(disk), options_(options), tokens_(tokens), promise_(std::move(promise)),
      limits_(options.links_max, options.greeting_max), machine_(std::make_unique<Machine>(world)),
      blocking_executor_(asio::make_strand(machine_->executor())) {
    world_.note("server starts");
    read_tokens();
    while (!log_) { // the supervisor restarts the server in this case
        if (auto log = disk_.open()) log_ = std::move(*log);
    }
    machine_->hasten();
    disk_.set_at_once(true);
    sessions::RegistryConfig config{.compute = machine_->executor(), .now = [] { return 1'000.0; }};
    config.clock = [this] { return world_.now(); };
    config.pages_max = options_.pages_max;
    config.idle_after = options_.idle_after;
    sessions_.emplace(*log_, std::move(config));
    sessions_->recover().value();
    disk_.set_at_once(false);
    machine_->go_on_normally();
    tidy();
}

Server::~Server() {
    world_.note("server ends");
    for (const auto& link : links_) link->vanish();
    disk_.crash();
    machine_->hasten();
    sessions_->drain(); // otherwise sessions, links and waiting callers would keep each other alive
    links_.clear();
    machine_->kill();
    sessions_.reset();
    log_.reset();
}

void Server::accept(std::shared_ptr<Connection> connection) {
    using Admission = ingest::ConnectionLimits::Admission;
    std::erase_if(links_, [](const auto& link) { return link->is_closed() && link.use_count() == 1; });
    const auto decision = limits_.on_accepted();
    if (decision.admission != Admission::kServe) tokens_.count("too_many_links");
    if (decision.admission == Admission::kClose) return connection->close(Side::kServer);
    if (decision.cut_off) (*std::ranges::find(links_, *decision.cut_off, &Link::id))->cut_off();
    const auto link = std::make_shared<Link>(*this, std::move(connection), decision.id);
    links_.push_back(link);
    if (decision.admission == Admission::kTurnAway) link->turn_away(limits_.too_many());
    if (decision.admission == Admission::kServe) check_links();
    link->start();
}

void Server::read_tokens() {
    if (!tokens_.is_open()) authenticator_.replace(tokens_.in_file());
}

/// Returns how many robots are connected with the token.
std::size_t Server::connected_with(const std::string& secret) const {
    std::set<std::pair<std::string, std::string>> robots;
    for (const auto& link : links_) {
        const auto* hello = link->granted();
        if (hello && hello->token == secret) robots.emplace(hello->session, hello->robot);
    }
    return robots.size();
}

/// Checks the limits of the open links. The newest of them is the one that asks to be served.
void Server::check_links() {
    const auto count = [this](bool (Link::*is)() const) {
        return static_cast<std::size_t>(
            std::ranges::count_if(links_, [is](const auto& link) { return !link->is_closed() && (*link.*is)(); }));
    };
    if (const auto served = count(&Link::is_served); served >= options_.links_max)
        tokens_.fail(fmt::format("one more link than {} is served", served));
    if (const auto waiting = count(&Link::is_waiting); waiting > options_.greeting_max)
        tokens_.fail(fmt::format("{} links have sent no hello", waiting));
}

void Server::stop() {
    machine_->hasten();
    disk_.set_at_once(true);
    sessions_->drain();
    disk_.set_at_once(false);
}

/// Runs each second, as in the program.
void Server::tidy() {
    asio::post(machine_->executor(), [this] {
        static_cast<void>(log_->reopen());
        sessions_->tidy();
    });
    world_.after(1s, [self = std::weak_ptr(self_)] {
        if (const auto alive = self.lock()) (*alive)->tidy();
    });
}

} // namespace scanloom::simulation
