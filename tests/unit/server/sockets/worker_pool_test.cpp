#include "server/sockets/worker_pool.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>
#include <gtest/gtest.h>

#include <atomic>
#include <new>

namespace scanloom::sockets {
namespace {

TEST(WorkerPool, ATaskThatThrowsEndsAlone) {
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
    EXPECT_EQ(done, 50) << "also those behind it on the same strand";
}

TEST(WorkerPool, JoinWaitsForWhatTasksPost) {
    WorkerPool pool(1);
    int done = 0;
    boost::asio::post(pool.get_executor(), [&] { boost::asio::post(pool.get_executor(), [&] { ++done; }); });
    pool.join();
    EXPECT_EQ(done, 1);
}

} // namespace
} // namespace scanloom::sockets
