#include "server/auth/audit_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <prometheus/registry.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <sstream>
#include <string>

namespace scanloom::auth {
namespace {

using auth::Port;
using auth::Reason;

/// Captures the log during its lifetime.
class Logged {
public:
    Logged() : before_(spdlog::default_logger()) {
        auto logger = std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
        logger->set_pattern("%l %v");
        spdlog::set_default_logger(std::move(logger));
    }
    ~Logged() { spdlog::set_default_logger(before_); }
    Logged(const Logged&) = delete;
    Logged& operator=(const Logged&) = delete;

    [[nodiscard]] std::string text() const { return text_.str(); }

private:
    std::ostringstream text_;
    std::shared_ptr<spdlog::logger> before_;
};

class AuditTest : public testing::Test {
protected:
    prometheus::Registry registry_;
    Logged logged_;
    double now_ = 100.0;
};

TEST_F(AuditTest, RefusalIsOneLine) {
    AuditLog audit(registry_, [this] { return now_; });
    audit.note({Port::kRobot, Reason::kWrongSession, "192.0.2.7", "depot", "lab"});
    EXPECT_EQ(logged_.text(), "warning event=refused port=robot who=192.0.2.7 token=depot reason=wrong_session "
                              "session=lab count=1\n");
}

TEST_F(AuditTest, FloodIsLoggedOncePerMinuteAndAtTheEnd) {
    const RefusalCounters counters(registry_); // the audit log's, as the registry has one of each name
    {
        AuditLog audit(registry_, [this] { return now_; });
        for (int n = 0; n < 1000; ++n) audit.note({Port::kHttp, Reason::kNoToken, "192.0.2.7", "", ""});
        now_ += 60.0;
        audit.note({Port::kHttp, Reason::kNoToken, "192.0.2.7", "", ""});
        EXPECT_THAT(logged_.text(), testing::EndsWith("token=- reason=no_token session=- count=999\n"));
    }
    EXPECT_THAT(logged_.text(), testing::EndsWith("token=- reason=no_token session=- count=1\n"));
    EXPECT_EQ(counters.of(Port::kHttp, Reason::kNoToken).Value(), 1001.0);
    EXPECT_EQ(counters.of(Port::kRobot, Reason::kNoToken).Value(), 0.0);
}

TEST_F(AuditTest, RestOfAFloodIsLoggedWithoutAnotherRefusal) {
    AuditLog audit(registry_, [this] { return now_; });
    for (int n = 0; n < 1000; ++n) audit.note({Port::kHttp, Reason::kNoToken, "192.0.2.7", "", ""});
    now_ += 59.0;
    audit.log_due();
    EXPECT_THAT(logged_.text(), testing::EndsWith("count=1\n"));
    now_ += 1.0;
    audit.log_due();
    EXPECT_THAT(logged_.text(), testing::EndsWith("count=999\n"));
}

TEST_F(AuditTest, StrangersAreLoggedOncePerSecondWithTheCount) {
    AuditLog audit(registry_, [&] { return now_; });
    EXPECT_EQ(audit.admit_log_line(), 0U);
    for (int n = 0; n < 3000; ++n) EXPECT_FALSE(audit.admit_log_line());
    now_ += 0.99;
    EXPECT_FALSE(audit.admit_log_line());
    now_ += 0.02;
    EXPECT_EQ(audit.admit_log_line(), 3001U);
    now_ += 1.0;
    EXPECT_EQ(audit.admit_log_line(), 0U);
}

TEST_F(AuditTest, ClientTextCannotForgeALine) {
    AuditLog audit(registry_, [this] { return now_; });
    audit.note({Port::kHttp, Reason::kWrongSession, "192.0.2.7", "depot", "a\nwarning event=refused who=somebody"});
    EXPECT_THAT(logged_.text(), testing::EndsWith("session=? count=1\n"));
    EXPECT_EQ(logged_.text().find('\n'), logged_.text().size() - 1);
}

} // namespace
} // namespace scanloom::auth
