#include "server/sockets/run_to_the_end.hpp"

#include <boost/asio/post.hpp>
#include <gtest/gtest.h>

#include <new>

namespace scanloom::sockets {
namespace {

TEST(RunToTheEnd, WhatThrowsEndsAlone) {
    boost::asio::io_context io;
    int done = 0;
    boost::asio::post(io, [] { throw std::bad_alloc(); });
    boost::asio::post(io, [&] { ++done; });
    boost::asio::post(io, [] { throw 7; });
    boost::asio::post(io, [&] { ++done; });
    run_to_the_end(io);
    EXPECT_EQ(done, 2);
}

} // namespace
} // namespace scanloom::sockets
