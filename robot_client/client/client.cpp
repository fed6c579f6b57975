#include "robot_client/client/client.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/frame_decoder.hpp"
#include "robot_client/client/pushed_source.hpp"
#include "robot_client/uplink/guidance.hpp"
#include "robot_client/uplink/live_feed.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <fmt/format.h>

#include <atomic>
#include <future>
#include <mutex>
#include <random>
#include <string_view>
#include <thread>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;
using std::chrono::milliseconds;

namespace {

/// Scans on their way to the client's thread. It takes them at once, unless the disk of its spool stands still.
constexpr std::size_t kHandedOverMax = 1024;

/// Refuses what a server would: each value is checked as it is there.
Result<> check(const Sensor& sensor, const Scan& scan) {
    std::string frame;
    wire::encode(sensor, frame);
    if (auto read = wire::decode(std::string_view(frame).substr(wire::kLengthPrefixBytes)); !read) return read.error();
    frame.clear();
    wire::ScanBatch batch{{scan}};
    batch.scans.front().seq = 1;
    wire::encode(batch, frame);
    if (auto read = wire::decode(std::string_view(frame).substr(wire::kLengthPrefixBytes)); !read) return read.error();
    if (scan.sensor != sensor.id) {
        return Error{Errc::kInvalidField,
                     fmt::format("the scan is of sensor {}, the sensor given is {}", scan.sensor, sensor.id)};
    }
    return wire::check_scan(scan, sensor);
}

Result<UplinkOptions> uplink_options(const ClientOptions& options) {
    for (const auto* name : {&options.session, &options.robot}) {
        if (is_valid_name(*name)) continue;
        return Error{Errc::kInvalidField,
                     fmt::format("'{}' is no name of a session or robot; use 1 to {} characters of "
                                 "A-Z a-z 0-9 _ -",
                                 *name, kNameBytesMax)};
    }
    if (options.body_radius && !is_body_radius(*options.body_radius)) {
        return Error{Errc::kInvalidField, fmt::format("a body_radius of {} m cannot be; give 0 to {}",
                                                      *options.body_radius, kBodyRadiusMax)};
    }
    const auto server = parse_server_address(options.server);
    if (!server) return Error{Errc::kInvalidField, fmt::format("'{}' is not HOST:PORT", options.server)};
    UplinkOptions uplink;
    uplink.server = *server;
    if (options.tls || !options.tls_ca_file.empty()) {
        auto tls = net::client_tls(options.tls_ca_file);
        if (!tls) return tls.error();
        uplink.tls = std::move(*tls);
    }
    uplink.give_up_after = uplink.give_up_after_end = milliseconds(0); // flush() has a patience of its own
    uplink.backoff_seed = std::random_device{}();
    uplink.conversation.buffer_bytes_max = options.memory_bytes_max;
    uplink.conversation.batch_delay = options.batch_delay;
    uplink.conversation.compress = options.compress;
    uplink.conversation.hello.session = options.session;
    uplink.conversation.hello.robot = options.robot;
    uplink.conversation.hello.token = options.token;
    uplink.conversation.hello.create = SessionOptions{};
    uplink.conversation.hello.create->cell_size = options.cell_size;
    uplink.conversation.hello.client = "scanloom client library";
    uplink.conversation.hello.body_radius = options.body_radius;
    uplink.on_trouble = [tell = options.tell, told = std::string()](const Error& error) mutable {
        if (error.message != std::exchange(told, error.message)) tell(error.message); // each is told once
    };
    return uplink;
}

Result<std::unique_ptr<Spool>> open_spool(const ClientOptions& options) {
    if (options.spool.empty()) return std::unique_ptr<Spool>{};
    return Spool::open({options.spool / fmt::format("{}.{}", options.session, options.robot), options.spool_bytes_max,
                        options.drop_newest ? WhenFull::kDropNewest : WhenFull::kDropOldest},
                       options.tell);
}

Error too_late(std::string_view what, milliseconds patience) {
    return {Errc::kTimeout, fmt::format("{} within {:g} s", what, std::chrono::duration<double>(patience).count())};
}

} // namespace

/// The uplink on a thread of its own.
class Client::Worker {
public:
    Worker(UplinkOptions uplink, std::unique_ptr<Spool> spool, LiveFeedOptions feed, double body_radius)
        : feed_(source_, std::move(spool), std::move(feed)), uplink_(io_, std::move(uplink), feed_),
          next_goal_(guided_by(uplink_, body_radius)), ended_(asio::co_spawn(io_, run(), asio::use_future)),
          thread_([this] { io_.run(); }) {}

    ~Worker() {
        io_.stop();
        thread_.join();
    }

    Result<> push(Observation observation) {
        if (auto failed = failure()) return *failed;
        if (on_their_way_.fetch_add(1) >= kHandedOverMax) {
            --on_their_way_;
            return Error{Errc::kOverloaded, fmt::format("{} scans wait to be taken up; the disk of the spool may stand "
                                                        "still",
                                                        kHandedOverMax)};
        }
        asio::post(io_, [this, observation = std::move(observation)]() mutable {
            source_.push(std::move(observation));
            --on_their_way_;
        });
        return {};
    }

    Result<> flush(milliseconds patience) {
        auto stored = asio::co_spawn(io_, until_stored(), asio::use_future);
        const auto until = std::chrono::steady_clock::now() + patience;
        if (stored.wait_until(until) == std::future_status::ready) return stored.get();
        return failure().value_or(too_late("not all scans were stored", patience));
    }

    Result<> close(milliseconds patience) {
        const auto until = std::chrono::steady_clock::now() + patience;
        if (auto flushed = flush(patience); !flushed) return flushed;
        asio::post(io_, [this] { source_.stop(); });
        if (ended_.wait_until(until) != std::future_status::ready)
            return too_late("the server did not answer", patience);
        if (auto failed = failure(); failed && failed->code != Errc::kGone) return *failed;
        return {};
    }

    template <class Value>
    Result<Value> ask(asio::awaitable<Result<Value>> question, milliseconds patience) {
        auto answer = asio::co_spawn(io_, std::move(question), asio::use_future);
        if (answer.wait_for(patience) == std::future_status::ready) return answer.get();
        if (auto failed = failure()) return *failed;
        return too_late("the server did not answer", patience);
    }

    asio::awaitable<Result<NextStop>> next_goal() { return next_goal_(); }

    asio::awaitable<Result<wire::Path>> plan(Point2 goal) {
        const auto reply = std::make_shared<std::optional<Result<wire::Path>>>();
        const auto bell = std::make_shared<Bell>();
        wire::PlanRequest request;
        request.goal = goal;
        const bool is_asked = uplink_.ask(request, [reply, bell](const Reply& got) {
            *reply = std::get<wire::PlanReply>(got).path;
            bell->ring();
        });
        if (!is_asked) co_return Error{Errc::kOverloaded, "too many questions to the server are open"};
        while (!*reply) co_await bell->wait();
        co_return **reply;
    }

    ClientStatus status() {
        auto asked = asio::post(io_, asio::use_future([this] {
                                    const UplinkStatus now = uplink_.status();
                                    return ClientStatus{now.acknowledged,
                                                        now.last - now.acknowledged + now.waiting + source_.waiting() +
                                                            on_their_way_.load(),
                                                        now.dropped, now.bytes, now.is_linked};
                                }));
        return asked.get();
    }

private:
    asio::awaitable<void> run() {
        const Result<> outcome = co_await uplink_.run();
        end(outcome ? Error{Errc::kGone, "the client was closed"} : outcome.error());
        over_.ring();
    }

    void end(Error why) {
        const std::lock_guard lock(mutex_);
        outcome_ = std::move(why);
    }

    asio::awaitable<Result<>> until_stored() {
        while (source_.waiting() > 0 && !failure()) co_await asio::post(io_, asio::use_awaitable);
        if (!failure()) co_await (uplink_.until_stored() || over_.wait());
        const auto failed = failure();
        if (failed) co_return *failed;
        co_return Result<>{};
    }

    std::optional<Error> failure() {
        const std::lock_guard lock(mutex_);
        return outcome_;
    }

    asio::io_context io_{1};
    asio::executor_work_guard<asio::io_context::executor_type> work_{io_.get_executor()};
    PushedSource source_;
    LiveFeed feed_;
    Uplink uplink_;
    NextGoal next_goal_;
    std::atomic<std::size_t> on_their_way_ = 0;
    Bell over_;
    std::mutex mutex_;
    std::optional<Error> outcome_; ///< guarded by mutex_
    std::future<void> ended_;
    std::thread thread_; // last: it uses the others
};

Result<std::unique_ptr<Client>> Client::start(ClientOptions options) {
    auto uplink = uplink_options(options);
    if (!uplink) return uplink.error();
    auto spool = open_spool(options);
    if (!spool) return spool.error();
    LiveFeedOptions feed;
    feed.when_full = options.drop_newest ? WhenFull::kDropNewest : WhenFull::kDropOldest;
    feed.tell = options.tell;
    constexpr double kDefaultBodyRadius = 0.15; // metres, as the server's
    return std::unique_ptr<Client>(new Client(std::make_unique<Worker>(
        std::move(*uplink), std::move(*spool), std::move(feed), options.body_radius.value_or(kDefaultBodyRadius))));
}

Client::Client(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}
Client::~Client() = default;

Result<> Client::send(const std::shared_ptr<const Sensor>& sensor, Scan scan) {
    if (!sensor) return Error{Errc::kInvalidField, "a scan needs its sensor"};
    if (auto ok = check(*sensor, scan); !ok) return ok;
    return worker_->push({sensor, std::move(scan)});
}

Result<> Client::flush(milliseconds patience) { return worker_->flush(patience); }
Result<> Client::close(milliseconds patience) { return worker_->close(patience); }

Result<std::vector<Point2>> Client::plan(const Point2& goal, milliseconds patience) {
    auto path = worker_->ask(worker_->plan(goal), patience);
    if (!path) return path.error();
    return std::move(path->points);
}

Result<ExplorationGoal> Client::next_goal(milliseconds patience) {
    auto stop = worker_->ask(worker_->next_goal(), patience);
    if (!stop) return stop.error();
    return ExplorationGoal{static_cast<ExplorationGoal::Outcome>(stop->outcome), std::move(stop->path), stop->target};
}

ClientStatus Client::status() const { return worker_->status(); }

} // namespace scanloom::robot
