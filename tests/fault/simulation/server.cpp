#include "tests/fault/simulation/server.hpp"

#include "common/link/server_protocol.hpp"
#include "server/ingest/join_session.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>

#include <algorithm>
#include <span>
#include <utility>

namespace scanloom::simulation {

namespace asio = boost::asio;
using namespace std::chrono_literals;

/// Connects a link::ServerProtocol to the simulated network and the sessions, as ingest::RobotConnection does for a
/// socket.
class Server::Link final : public sessions::RobotListener, public std::enable_shared_from_this<Link> {
public:
    Link(Server& server, std::shared_ptr<Connection> connection)
        : server_(server), connection_(std::move(connection)), strand_(server.machine_->executor()),
          protocol_({.idle_deadline = server.options_.idle_deadline, .credit_bytes = server.options_.credit_bytes},
                    server.world_.now()) {}

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

    [[nodiscard]] bool is_closed() const { return closed_; }

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
        asio::co_spawn(strand_, join(shared_from_this(), std::move(action.hello)), asio::detached);
    }
    void perform(Protocol::SubmitSensor&& action) {
        session_->submit(shared_from_this(), std::move(action.sensor), action.bytes);
    }
    void perform(Protocol::SubmitScans&& action) {
        session_->submit(shared_from_this(), std::move(action.scans), action.bytes);
    }
    void perform(Protocol::AnswerRequest&& action) {
        protocol_.on_request_refused(action.request, {Errc::kOverloaded, "requests are not simulated"});
    }
    void perform(Protocol::RecordLimit&&) {}
    void perform(Protocol::Leave&&) {
        if (protocol_.ended_by()) server_.world_.note(protocol_.ended_by()->message);
        if (session_) session_->leave(shared_from_this());
    }
    void perform(Protocol::Send&& action) {
        if (action.durable_seq) server_.promise_(robot_, *action.durable_seq);
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
    }

    static asio::awaitable<void> join(std::shared_ptr<Link> self, wire::Hello hello) {
        const sessions::Creator maker;
        auto session =
            co_await ingest::session_for(hello, self->server_.sessions(), maker, self->server_.machine_->executor());
        if (!session) {
            self->handle([&] { self->protocol_.on_not_joined(session.error()); });
            co_return;
        }
        auto joined = co_await ingest::join_session(**session, hello, self);
        if (!joined) {
            self->handle([&] { self->protocol_.on_not_joined(joined.error()); });
            co_return;
        }
        if (self->closed_) (*session)->leave(self);
        self->handle([&] {
            self->robot_ = hello.robot;
            self->session_ = *session;
            self->server_.promise_(hello.robot, joined->last_durable_seq);
            self->protocol_.on_joined({sessions::tag_of((*session)->info()), joined->last_durable_seq, joined->sensors},
                                      self->server_.world_.now());
        });
    }

    Server& server_;
    std::shared_ptr<Connection> connection_;
    asio::strand<asio::any_io_executor> strand_;
    Protocol protocol_;
    std::shared_ptr<sessions::Session> session_; // joined
    std::string robot_;
    std::string received_;   // not read yet
    bool has_ended_ = false; // no more data arrives
    Time timer_expiry_ = Time::max();
    bool closed_ = false;
};

Server::Server(World& world, Disk& disk, const ServerOptions& options, Promise promise)
    : world_(world), disk_(disk), options_(options), promise_(std::move(promise)),
      machine_(std::make_unique<Machine>(world)) {
    world_.note("server starts");
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
    std::erase_if(links_, [](const auto& link) { return link->is_closed() && link.use_count() == 1; });
    links_.push_back(std::make_shared<Link>(*this, std::move(connection)));
    links_.back()->start();
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
