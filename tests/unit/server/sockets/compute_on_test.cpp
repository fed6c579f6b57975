#include "server/sockets/compute_on.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>

namespace scanloom::sockets {
namespace {

namespace asio = boost::asio;

/// A coroutine here that has a piece of work done elsewhere; both run by hand.
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

TEST_F(ComputeOnTest, GoesOnAtOnceWhenItIsDoneThoughOtherWorkWaitsThere) {
    begin([] { return 7; });
    asio::post(elsewhere_, [] {});
    elsewhere_.run_one();
    here_.poll();
    EXPECT_EQ(made_, 7);
    EXPECT_EQ(elsewhere_.poll(), 1U) << "the other work alone is left";
}

TEST_F(ComputeOnTest, IsDoneThereAndTheContextHereWaitsForIt) {
    std::optional<bool> done_there;
    begin([&] {
        done_there = elsewhere_.get_executor().running_in_this_thread();
        return 0;
    });
    EXPECT_FALSE(done_there);
    EXPECT_FALSE(here_.stopped()) << "it would end before the answer";
    elsewhere_.run();
    EXPECT_EQ(done_there, true);
    EXPECT_FALSE(made_) << "what follows is done here";
    here_.run();
    EXPECT_EQ(made_, 0);
}

TEST_F(ComputeOnTest, WhatIsThrownIsThrownHere) {
    begin([]() -> int { throw std::runtime_error("no"); });
    elsewhere_.run();
    here_.run();
    ASSERT_TRUE(failed_);
    EXPECT_THROW(std::rethrow_exception(failed_), std::runtime_error);
}

} // namespace
} // namespace scanloom::sockets
