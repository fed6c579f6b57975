#pragma once

#include "server/sessions/session_registry.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <future>
#include <latch>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace scanloom::sessions {

/// A link that is called by other threads. Tests wait for its events.
struct AwaitedLink : RobotListener {
    void on_durable(std::uint64_t seq, std::size_t) override {
        const std::lock_guard lock(mutex);
        durable_seq = seq;
        changed.notify_all();
    }
    void on_failed(const Error& error) override {
        const std::lock_guard lock(mutex);
        failure = error;
        changed.notify_all();
    }
    void wait_for_seq(std::uint64_t seq) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return durable_seq >= seq; });
    }
    /// Waits until the scan is durable or the link fails.
    /// @return whether the scan is durable
    bool wait_for_seq_or_failure(std::uint64_t seq) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return durable_seq >= seq || failure; });
        return durable_seq >= seq;
    }
    Error wait_for_failure() {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return failure.has_value(); });
        return *failure;
    }

    std::mutex mutex;
    std::condition_variable changed;
    std::uint64_t durable_seq = 0;
    std::optional<Error> failure;
};

inline Result<Joined> join_and_wait(Session& session, const std::string& robot, std::shared_ptr<RobotListener> link) {
    const auto promise = std::make_shared<std::promise<Result<Joined>>>();
    auto joined = promise->get_future();
    session.join({robot}, std::move(link), [promise](Result<Joined> answer) { promise->set_value(std::move(answer)); });
    return joined.get();
}

/// A registry with a thread pool, as in the server. The test's thread makes the blocking calls.
class SessionRegistryTest : public testing::Test {
protected:
    ~SessionRegistryTest() override {
        reading_.join();
        compute_.join();
    }

    /// Creates a registry that knows only what the log contains.
    void restart(std::size_t pages_max = RegistryConfig{}.pages_max) {
        registry_ = make(log_, pages_max);
        ASSERT_TRUE(registry_->recover());
    }

    /// Waits until the pools have run every task that was posted to them before.
    void wait_for_posted_tasks() {
        for (auto* pool : {&compute_, &reading_}) {
            const auto free_threads = std::make_shared<std::latch>(kThreads); // of all threads, so no task is running
            for (std::ptrdiff_t n = 0; n < kThreads; ++n) {
                boost::asio::post(*pool, [free_threads] { free_threads->arrive_and_wait(); });
            }
            free_threads->wait();
        }
    }

    std::unique_ptr<SessionRegistry> make(store::ScanLog& log, std::size_t pages_max = RegistryConfig{}.pages_max) {
        return std::make_unique<SessionRegistry>(log, RegistryConfig{.compute = compute_.get_executor(),
                                                                     .now = [] { return 1000.5; },
                                                                     .reading = reading_.get_executor(),
                                                                     .clock = [this] { return clock_.load(); },
                                                                     .pages_max = pages_max});
    }

    std::shared_ptr<AwaitedLink> stream(Session& session, const std::string& robot, std::size_t scans) {
        auto link = std::make_shared<AwaitedLink>();
        EXPECT_TRUE(join_and_wait(session, robot, link));
        session.submit(link, small_laser(), 0);
        for (std::uint64_t seq = 1; seq <= scans; ++seq) session.submit(link, {random_scan(7, seq)}, 0);
        link->wait_for_seq(scans);
        return link;
    }

    std::atomic<SessionCache::Clock::time_point> clock_ = SessionCache::Clock::time_point(std::chrono::hours(1));
    store::MemoryScanLog log_;
    static constexpr std::ptrdiff_t kThreads = 2; // of each pool
    boost::asio::thread_pool compute_{kThreads};
    boost::asio::thread_pool reading_{kThreads};
    std::unique_ptr<SessionRegistry> registry_ = make(log_);
};

} // namespace scanloom::sessions
