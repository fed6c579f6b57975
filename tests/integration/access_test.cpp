#include "tests/integration/ingest_fixture.hpp"

#include "server/auth/token.hpp"

namespace scanloom::ingest {
namespace {

using auth::Reason;
using auth::Role;
using auth::Token;
using auth::TokenSet;
using testing::HasSubstr;

auth::TokenRef token(std::string name, Role role, std::vector<std::string> sessions, auth::Limits limits = {}) {
    const auto hash = auth::hash_of("secret of " + name);
    return std::make_shared<const Token>(Token{std::move(name), hash, role, std::move(sessions), limits});
}

/// Robots that need a token for their link.
class AccessTest : public IngestTest {
protected:
    AccessTest() { start().authenticator().replace(TokenSet(all_)); }

    /// Returns the hello of a robot with the token of that name; empty: without a token.
    static wire::Hello hello_of(const std::string& who, const std::string& session, const std::string& robot = "r1") {
        auto said = hello(robot, session);
        said.token = who.empty() ? "" : "secret of " + who;
        return said;
    }

    wire::LinkError refusal(const wire::Hello& hello) {
        RobotSocket robot(port());
        robot.send(hello);
        return farewell_to(robot);
    }

    [[nodiscard]] double refusals(Reason reason) { return running_->refusals().of(auth::Port::kRobot, reason).Value(); }

    std::vector<auth::TokenRef> all_ = {
        token("robot", Role::kRobot, {"depot-*"}),
        token("viewer", Role::kViewer, {"*"}),
        token("operator", Role::kOperator, {"lab"}),
    };
};

TEST_F(AccessTest, TokensPermitTheirOwnSessions) {
    for (const auto& [who, session] : {std::pair("robot", "depot-1"), std::pair("operator", "lab")}) {
        const auto robot = welcomed(port(), hello_of(who, session)); // creates the session
        robot->send(wire::Goodbye{""});
        EXPECT_EQ(robot->receive(), std::nullopt);
    }
    struct Case {
        const char* who;
        const char* session;
        const char* says;
        Reason reason;
    };
    const std::vector<Case> cases = {
        {"", "depot-1", "hello.token: a token is needed", Reason::kNoToken},
        {"stranger", "depot-1", "hello.token: the token that was sent is not valid here", Reason::kUnknownToken},
        {"viewer", "depot-1", "hello.token: the token 'viewer' has the role viewer", Reason::kWrongRole},
        {"robot", "lab", "hello.token: the token 'robot' is not for the session 'lab'", Reason::kWrongSession},
        {"operator", "depot-1", "hello.token: the token 'operator' is not for the session", Reason::kWrongSession},
    };
    for (const auto& [who, session, says, reason] : cases) {
        const auto before = refusals(reason);
        const auto refused = refusal(hello_of(who, session));
        EXPECT_EQ(refused.error.code, Errc::kUnauthorized) << refused.error.message;
        EXPECT_FALSE(refused.retryable) << refused.error.message;
        EXPECT_THAT(refused.error.message, testing::StartsWith(says));
        EXPECT_EQ(refusals(reason), before + 1.0) << says;
    }
}

TEST_F(AccessTest, ErrorsDoNotRevealWhichSessionsExist) {
    const auto made = welcomed(port(), hello_of("robot", "depot-1"));
    for (const auto* who : {"", "stranger", "operator", "viewer"}) {
        auto there = hello_of(who, "depot-1");
        auto not_there = hello_of(who, "depot-9");
        there.create = not_there.create = std::nullopt;
        auto one = refusal(there).error.message;
        auto other = refusal(not_there).error.message;
        if (const auto at = other.find("depot-9"); at != std::string::npos) other.replace(at, 7, "depot-1");
        EXPECT_EQ(one, other);
    }
    EXPECT_EQ(running_->sessions().find("depot-9"), nullptr);
    made->send(wire::Goodbye{""});
    EXPECT_EQ(made->receive(), std::nullopt);
}

TEST_F(AccessTest, RevokingATokenEndsItsLinksOnly) {
    const auto gone = welcomed(port(), hello_of("robot", "depot-1"));
    const auto stays = welcomed(port(), hello_of("operator", "lab"));
    stays->send(small_laser());
    running_->authenticator().replace(TokenSet({all_[2]}));
    const auto end = farewell_to(*gone);
    EXPECT_EQ(end.error.code, Errc::kUnauthorized);
    EXPECT_FALSE(end.retryable);
    EXPECT_THAT(end.error.message, HasSubstr("the token 'robot' no longer permits this"));
    EXPECT_EQ(refusals(Reason::kRevoked), 1.0);
    stream(*stays, 1, 1, 10);
    stays->send(wire::Goodbye{""});
    while (stays->receive()) {
    }
}

TEST_F(AccessTest, ScansAcknowledgedBeforeTheRevocationStay) {
    const auto robot = welcomed(port(), hello_of("robot", "depot-1"));
    robot->send(small_laser());
    stream(*robot, 1, 1, 20);
    running_->authenticator().replace(TokenSet({all_[2]}));
    static_cast<void>(farewell_to(*robot));
    EXPECT_EQ(running_->snapshot("depot-1")->robots.at(0).last_seq, 20U);
}

class LimitsTest : public AccessTest {
protected:
    /// Robots with a token that has only this limit.
    std::unique_ptr<RobotSocket> robot_with(const auth::Limits& limits, const std::string& robot = "r1") {
        running_->authenticator().replace(TokenSet({token("robot", Role::kRobot, {"*"}, limits)}));
        return welcomed(port(), hello_of("robot", "lab", robot));
    }

    static void expect_limit(RobotSocket& robot, const std::string& limit) {
        const auto end = farewell_to(robot);
        EXPECT_FALSE(end.retryable) << end.error.message;
        EXPECT_THAT(end.error.message, AllOf(HasSubstr("`" + limit + "`"), HasSubstr("'robot'")));
    }
};

TEST_F(LimitsTest, ConnectionsAreLimitedPerToken) {
    const auto one = robot_with({.connections = 1});
    const auto refused = refusal(hello_of("robot", "lab", "r2"));
    EXPECT_EQ(refused.error.code, Errc::kOverloaded);
    EXPECT_TRUE(refused.retryable) << "the other link may end";
    EXPECT_THAT(refused.error.message, HasSubstr("`connections`"));
    const auto again = welcomed(port(), hello_of("robot", "lab", "r1")); // replaces its own earlier link
    EXPECT_EQ(farewell_to(*one).error.code, Errc::kReplaced);
    again->send(wire::Goodbye{""});
    EXPECT_EQ(again->receive(), std::nullopt);
    EXPECT_EQ(refusals(Reason::kLimit), 1.0);
}

TEST_F(LimitsTest, SensorsAreLimitedPerRobotOverAllLinks) {
    const auto first = robot_with({.sensors = 2});
    auto sensor = small_laser();
    for (const std::uint32_t id : {0U, 1U, 0U}) {
        sensor.id = id;
        first->send(sensor);
    }
    first->send(wire::Goodbye{""});
    while (first->receive()) {
    }
    const auto second = welcomed(port(), hello_of("robot", "lab"));
    sensor.id = 2;
    second->send(sensor);
    expect_limit(*second, "sensors");
    EXPECT_EQ(refusals(Reason::kLimit), 1.0);
}

TEST_F(LimitsTest, BeamsAreLimitedPerScan) {
    const auto beams = random_scan(1, 1).ranges.size();
    const auto robot = robot_with({.beams = beams});
    robot->send(small_laser());
    stream(*robot, 1, 1, 10);
    running_->authenticator().replace(TokenSet({token("robot", Role::kRobot, {"*"}, {.beams = beams - 1})}));
    // The link applies the new limit before it reads anything that is sent after this line.
    robot->send(wire::ScanBatch{{random_scan(1, 11)}});
    expect_limit(*robot, "beams");
    EXPECT_EQ(running_->snapshot("lab")->robots.at(0).last_seq, 10U);
}

TEST_F(LimitsTest, SessionsAreLimitedPerCreatingToken) {
    const auto robot = robot_with({.sessions = 1});
    EXPECT_EQ(running_->sessions().find("lab")->info().created_by, "robot");
    const auto refused = refusal(hello_of("robot", "second"));
    EXPECT_EQ(refused.error.code, Errc::kFull);
    EXPECT_THAT(refused.error.message, HasSubstr("`sessions`"));
    EXPECT_EQ(refusals(Reason::kLimit), 1.0);
    robot->send(wire::Goodbye{""});
    EXPECT_EQ(robot->receive(), std::nullopt);
}

TEST_F(LimitsTest, CellsAreLimitedByTheCreatingToken) {
    const auto robot = robot_with({.cells = 4096});
    robot->send(small_laser());
    robot->send(wire::ScanBatch{random_scans(1, 1, 10)});
    const auto end = farewell_to(*robot);
    EXPECT_EQ(end.error.code, Errc::kFull);
    EXPECT_THAT(end.error.message, AllOf(HasSubstr("`cells`"), HasSubstr("'robot'")));
}

TEST_F(LimitsTest, TooFastInputIsDelayedWithoutLoss) {
    const auto robot = robot_with({.bytes_per_second = 32'000}); // 400 scans are about 50 kB
    robot->send(small_laser());
    stream(*robot, 1, 1, 400);
    EXPECT_GT(running_->counters().held_back_seconds.Value(), 0.0);
    robot->send(wire::Goodbye{""});
    while (robot->receive()) {
    }
    EXPECT_EQ(running_->snapshot("lab")->robots.at(0).last_seq, 400U);
}

TEST_F(LimitsTest, ADelayedLinkEndsWhenItsTokenIsRevoked) {
    const auto robot = robot_with({.bytes_per_second = auth::kBytesPerSecondMin});
    robot->send(small_laser());
    robot->send(wire::ScanBatch{random_scans(1, 1, 400)});
    while (running_->counters().held_back_seconds.Value() == 0.0) std::this_thread::yield();
    running_->authenticator().replace(TokenSet({all_[2]}));
    EXPECT_EQ(farewell_to(*robot).error.code, Errc::kUnauthorized);
}

} // namespace
} // namespace scanloom::ingest
