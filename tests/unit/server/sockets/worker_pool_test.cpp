#include "server/sockets/worker_pool.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>
#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <optional>
#include <stdexcept>

namespace scanloom::sockets {
namespace {

TEST(RunToCompletion, ContinuesAfterAnException) {
    boost::asio::io_context io;
    int done = 0;
    boost::asio::post(io, [] { throw std::bad_alloc(); });
    boost::asio::post(io, [&] { ++done; });
    boost::asio::post(io, [] { throw 7; });
    boost::asio::post(io, [&] { ++done; });
    run_to_completion(io);
    EXPECT_EQ(done, 2);
}

TEST(WorkerPool, ContinuesAfterAnException) {
    WorkerPool pool(2);
    const auto strand = boost::asio::make_strand(pool.get_executor());
    std::atomic<int> done = 0;
    for (int task = 0; task < 100; ++task) {
        boost::asio::post(strand, [&, task] {
            if (task % 2 == 0) throw std::bad_alloc();
            ++done;
        });
    }
    pool.join();
    EXPECT_EQ(done, 50) << "also later tasks on the same strand";
}

TEST(WorkerPool, JoinWaitsForTasksPostedByTasks) {
    WorkerPool pool(1);
    int done = 0;
    boost::asio::post(pool.get_executor(), [&] { boost::asio::post(pool.get_executor(), [&] { ++done; }); });
    pool.join();
    EXPECT_EQ(done, 1);
}

namespace asio = boost::asio;

/// A coroutine that runs work on another executor; the test polls both.
class ComputeOnTest : public testing::Test {
protected:
    template <class Work>
    void begin(Work work) {
        asio::co_spawn(
            here_,
            [this, work]() -> asio::awaitable<int> { co_return co_await compute_on(elsewhere_.get_executor(), work); },
            [this](std::exception_ptr failed, int made) {
                failed_ = failed;
                made_ = made;
            });
        here_.poll();
    }

    asio::io_context here_;
    asio::io_context elsewhere_;
    std::optional<int> made_;
    std::exception_ptr failed_;
};

TEST_F(ComputeOnTest, ResumesAheadOfQueuedWork) {
    begin([] { return 7; });
    asio::post(elsewhere_, [] {});
    elsewhere_.run_one();
    here_.poll();
    EXPECT_EQ(made_, 7);
    EXPECT_EQ(elsewhere_.poll(), 1U) << "only the other work is left";
}

TEST_F(ComputeOnTest, RunsOnTheExecutorWhileTheContextWaits) {
    std::optional<bool> done_there;
    begin([&] {
        done_there = elsewhere_.get_executor().running_in_this_thread();
        return 0;
    });
    EXPECT_FALSE(done_there);
    EXPECT_FALSE(here_.stopped()) << "it would end before the result";
    elsewhere_.run();
    EXPECT_EQ(done_there, true);
    EXPECT_FALSE(made_) << "the continuation runs here";
    here_.run();
    EXPECT_EQ(made_, 0);
}

TEST_F(ComputeOnTest, RethrowsTheExceptionOfTheWork) {
    begin([]() -> int { throw std::runtime_error("no"); });
    elsewhere_.run();
    here_.run();
    ASSERT_TRUE(failed_);
    EXPECT_THROW(std::rethrow_exception(failed_), std::runtime_error);
}

} // namespace
} // namespace scanloom::sockets
