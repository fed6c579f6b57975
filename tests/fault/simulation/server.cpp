#include "tests/fault/simulation/server.hpp"

#include "common/wire/compression.hpp"
#include "common/wire/frame_decoder.hpp"
#include "server/ingest/entrance.hpp"
#include "server/ingest/robot_link.hpp"

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

/// Does for a simulated connection what ingest::RobotLink does for a socket.
class Server::Link final : public session::RobotListener, public std::enable_shared_from_this<Link> {
public:
    Link(Server& server, std::shared_ptr<Connection> connection)
        : server_(server), connection_(std::move(connection)), strand_(server.machine_->executor()),
          outbox_([this] { write_soon(); }),
          dialogue_(server.metrics_.ingest(), outbox_, server.options_.credit_bytes) {}

    void start() {
        const std::weak_ptr<Link> weak = weak_from_this();
        connection_->listen(Side::kServer, {[weak](std::string_view bytes) {
                                                if (const auto self = weak.lock()) self->on_bytes(bytes);
                                            },
                                            [weak] {
                                                if (const auto self = weak.lock()) self->part();
                                            }});
        heard_ = server_.world_.now();
        watch();
    }

    void on_durable(std::uint64_t durable_seq, std::size_t bytes) override {
        later([durable_seq, bytes](Link& self) {
            if (!self.parted_) self.dialogue_.on_durable(durable_seq, bytes);
            self.part_when_settled();
        });
    }
    void on_failed(const Error& error) override {
        later([error](Link& self) { self.end(error); });
    }

    [[nodiscard]] bool has_parted() const { return parted_; }

    /// The program has ended.
    void vanish() {
        if (!parted_) connection_->vanish(Side::kServer);
        parted_ = true;
    }

private:
    template <class Work>
    void later(Work work) {
        asio::post(strand_, [self = shared_from_this(), work] { work(*self); });
    }

    void on_bytes(std::string_view bytes) {
        heard_ = server_.world_.now();
        std::ranges::copy(std::as_bytes(std::span(bytes)), decoder_.prepare(bytes.size()).begin());
        decoder_.commit(bytes.size());
        take_frames();
    }

    void take_frames() {
        while (!parted_ && !ending_ && !entering_ && !dialogue_.said_goodbye()) {
            const auto body = decoder_.next();
            if (!body) return end(body.error());
            if (!*body) return;
            auto message = wire::decode(**body);
            if (!message) return end(message.error());
            if (auto taken = take(std::move(*message), wire::kLengthPrefixBytes + (*body)->size()); !taken) {
                return end(taken.error());
            }
        }
    }

    Result<> take(wire::Message message, std::size_t bytes) {
        if (auto* hello = std::get_if<wire::Hello>(&message); hello != nullptr && !dialogue_.is_welcome()) {
            entering_ = true;
            asio::co_spawn(strand_, enter(shared_from_this(), std::move(*hello)), asio::detached);
            return {};
        }
        if (!dialogue_.is_welcome()) return Error{Errc::kMalformed, "a hello is expected"};
        if (const auto* compressed = std::get_if<wire::CompressedScanBatch>(&message)) {
            auto batch = wire::decompress(*compressed);
            if (!batch) return batch.error();
            bytes = wire::bytes_under_way(*compressed);
            message = std::move(*batch);
        }
        auto handled = dialogue_.handle(std::move(message), bytes, server_.world_.now(), shared_from_this());
        if (dialogue_.said_goodbye()) part_when_settled();
        return handled;
    }

    static asio::awaitable<void> enter(std::shared_ptr<Link> self, wire::Hello hello) {
        const session::Maker anybody;
        auto entered =
            co_await ingest::session_for(hello, self->server_.sessions(), anybody, self->server_.machine_->executor());
        if (!entered) {
            self->end(entered.error());
            co_return;
        }
        const auto joined = co_await ingest::join(**entered, hello, self);
        self->entering_ = false;
        if (!joined) {
            self->end(joined.error());
        } else if (self->parted_) {
            (*entered)->leave(self);
        } else {
            self->decoder_.set_frame_bytes_max(wire::kFrameBytesMax);
            self->robot_ = hello.robot;
            self->server_.promise_(hello.robot, joined->last_durable_seq);
            self->dialogue_.welcome(std::move(*entered), *joined);
            self->take_frames();
        }
    }

    void write_soon() {
        if (std::exchange(writing_, true)) return;
        later([](Link& self) { self.write(); });
    }

    void write() {
        writing_ = false;
        if (parted_) return;
        while (auto piece = outbox_.next()) {
            if (piece->durable_seq) {
                dialogue_.acknowledged(*piece->durable_seq, server_.world_.now());
                server_.promise_(robot_, *piece->durable_seq);
            }
            connection_->send(Side::kServer, std::move(piece->bytes));
        }
        if (ending_) part();
    }

    void end(const Error& error) {
        if (parted_ || std::exchange(ending_, true)) return;
        server_.world_.note(error.message);
        outbox_.send(wire::LinkError{error, ingest::is_retryable(error.code)});
        outbox_.close();
    }

    void part_when_settled() {
        if (!parted_ && dialogue_.said_goodbye() && !dialogue_.has_under_way()) later([](Link& self) { self.part(); });
    }

    void part() {
        if (std::exchange(parted_, true)) return;
        if (dialogue_.is_welcome()) dialogue_.session()->leave(shared_from_this());
        connection_->close(Side::kServer);
    }

    void watch() {
        const Time due = heard_ + server_.options_.idle_deadline;
        if (server_.world_.now() >= due) return end({Errc::kTimeout, "nothing was received for too long"});
        server_.world_.at(due, [weak = weak_from_this()] {
            const auto self = weak.lock();
            if (self && !self->parted_) self->watch();
        });
    }

    Server& server_;
    std::shared_ptr<Connection> connection_;
    asio::strand<asio::any_io_executor> strand_;
    wire::FrameDecoder decoder_{wire::kFrameBytesMaxBeforeHello};
    ingest::Outbox outbox_;
    ingest::Dialogue dialogue_;
    std::string robot_; // after the welcome
    Time heard_{};
    bool entering_ = false;
    bool writing_ = false;
    bool ending_ = false; // received data is ignored
    bool parted_ = false;
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
    session::RegistryConfig config{.compute = machine_->executor(), .now = [] { return 1'000.0; }};
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
    std::erase_if(links_, [](const auto& link) { return link->has_parted() && link.use_count() == 1; });
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
