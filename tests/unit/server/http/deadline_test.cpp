#include "server/http/deadline.hpp"

#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <memory>

namespace scanloom::http {
namespace {

using namespace std::chrono_literals;

/// Owns a deadline and counts its expirations.
struct Owner : std::enable_shared_from_this<Owner> {
    explicit Owner(boost::asio::io_context& io) : deadline(io.get_executor()) {}

    void watch() {
        deadline.watch(weak_from_this(), [this] { ++passed; });
    }

    Deadline deadline;
    int passed = 0;
};

/// run() returns when no timer is pending, so that these tests need no clock.
class DeadlineTest : public testing::Test {
protected:
    DeadlineTest() { owner_->watch(); }

    boost::asio::io_context io_;
    std::shared_ptr<Owner> owner_ = std::make_shared<Owner>(io_);
};

TEST_F(DeadlineTest, ExpiresOnce) {
    owner_->deadline.set_after(0ms);
    io_.run();
    EXPECT_EQ(owner_->passed, 1);
}

TEST_F(DeadlineTest, EarlierDeadlineExpiresEarlier) {
    owner_->deadline.set_after(1h);
    owner_->deadline.set_after(0ms);
    io_.run();
    EXPECT_EQ(owner_->passed, 1);
}

TEST_F(DeadlineTest, PostponedDeadlineExpiresLater) {
    owner_->deadline.set_after(0ms);
    const auto later = Deadline::Clock::now() + 20ms;
    owner_->deadline.set(later);
    io_.run();
    EXPECT_EQ(owner_->passed, 1);
    EXPECT_GE(Deadline::Clock::now(), later);
}

TEST_F(DeadlineTest, ClearedDeadlineDoesNotExpire) {
    owner_->deadline.set_after(0ms);
    owner_->deadline.clear();
    io_.run();
    EXPECT_EQ(owner_->passed, 0);
    owner_->deadline.set_after(0ms);
    io_.restart();
    io_.run();
    EXPECT_EQ(owner_->passed, 1) << "but the next does";
}

TEST_F(DeadlineTest, StopEndsTheWait) {
    owner_->deadline.set_after(1h);
    owner_->deadline.stop();
    io_.run();
    EXPECT_EQ(owner_->passed, 0);
}

TEST_F(DeadlineTest, DestroyedOwnerIsNotCalled) {
    owner_->deadline.set_after(1h);
    owner_.reset();
    EXPECT_GE(io_.run(), 0U); // returns
}

} // namespace
} // namespace scanloom::http
