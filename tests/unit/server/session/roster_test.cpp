#include "server/session/roster.hpp"

#include "tests/unit/server/session/session_fixture.hpp"

#include <chrono>
#include <string>
#include <vector>

namespace scanloom::session {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Time = Roster::Clock::time_point;

Time at(int second) { return Time(std::chrono::seconds(second)); }

/// A roster of sessions without a single scan, which nobody holds but it.
class RosterTest : public SessionTest {
protected:
    void add(const std::string& name, int second) {
        roster_.add(std::make_shared<Session>(SessionInfo{++last_id_, name, 0.0, config_}, mapping::Projection(config_),
                                              0, log_, compute_.get_executor()),
                    at(second));
    }

    void add_asleep(const std::string& name) {
        roster_.add(SessionInfo{++last_id_, name, 0.0, config_}, summary_of(mapping::Snapshot{}));
    }

    std::vector<std::string> send_to_sleep(int second, std::size_t pages = 1) {
        std::vector<std::string> names;
        for (const auto& session : roster_.send_to_sleep(at(second), pages)) names.push_back(session->info().name);
        return names;
    }

    /// What wakers are told: the name of the session, or why not.
    Roster::Woken note(std::string who) {
        return [this, who = std::move(who)](const Result<std::shared_ptr<Session>>& session) {
            told_.push_back(who + ": " +
                            (!session   ? session.error().message
                             : *session ? (*session)->info().name
                                        : "none"));
        };
    }

    void expect_awake(const std::string& name, bool awake) {
        EXPECT_EQ(roster_.find(name, at(0)) != nullptr, awake) << name;
        EXPECT_EQ(roster_.must_be_waited_for(name), !awake) << name;
    }

    store::SessionId last_id_ = 0;
    Roster roster_;
    std::vector<std::string> told_;
};

TEST_F(RosterTest, OneOfThoseWhoWantASleepingSessionReadsItForAll) {
    add_asleep("a");
    const auto resting = roster_.want("a", at(1), note("first"));
    ASSERT_TRUE(resting);
    EXPECT_EQ(resting->info.name, "a");
    EXPECT_FALSE(roster_.want("a", at(1), note("second")));
    EXPECT_THAT(told_, IsEmpty());
    expect_awake("a", false);
    roster_.arrived(
        std::make_shared<Session>(resting->info, mapping::Projection(config_), 0, log_, compute_.get_executor()),
        at(2));
    EXPECT_THAT(told_, ElementsAre("first: a", "second: a"));
    expect_awake("a", true);
}

TEST_F(RosterTest, ThoseThatWereNotUsedLongestGoFirstAndNoMoreThanAreNeeded) {
    add("older", 10);
    add("newer", 20);
    add("used", 5);
    ASSERT_TRUE(roster_.find("used", at(30)));
    EXPECT_THAT(send_to_sleep(9), IsEmpty()) << "each was used later";
    EXPECT_THAT(send_to_sleep(25, 0), IsEmpty()) << "none is needed";
    EXPECT_THAT(send_to_sleep(25), ElementsAre("older", "newer")) << "neither has a page";
    expect_awake("older", false);
    expect_awake("used", true);
}

TEST_F(RosterTest, WhoWantsASessionThatIsFallingAsleepGetsItWhenItHasBeenReadAgain) {
    add("a", 0);
    ASSERT_THAT(send_to_sleep(1), ElementsAre("a"));
    EXPECT_FALSE(roster_.want("a", at(2), note("late"))) << "it is another's, until it sleeps";
    const auto resting = roster_.arrived("a", summary_of(mapping::Snapshot{}));
    ASSERT_TRUE(resting) << "now it is to be read";
    EXPECT_THAT(told_, IsEmpty());
}

TEST_F(RosterTest, WhatIsShownOfASleepingSessionIsWhatItWas) {
    add("a", 0);
    ASSERT_THAT(send_to_sleep(1), ElementsAre("a"));
    mapping::Snapshot last{.revision = 7};
    last.robots.resize(2);
    EXPECT_FALSE(roster_.arrived("a", summary_of(last)));
    const auto listed = roster_.all();
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_EQ(listed[0].session, nullptr);
    EXPECT_EQ(listed[0].summary.facts->revision, 7U);
    EXPECT_EQ(listed[0].summary.facts->robots.size(), 2U);
    EXPECT_THAT(roster_.awake(), IsEmpty());
}

TEST_F(RosterTest, WhoWaitsForASessionThatIsRemovedIsTold) {
    add("a", 0);
    ASSERT_TRUE(roster_.leave("a"));
    EXPECT_FALSE(roster_.want("a", at(1), note("late")));
    roster_.remove("a", {Errc::kGone, "deleted"});
    EXPECT_THAT(told_, ElementsAre("late: deleted"));
    EXPECT_FALSE(roster_.contains("a"));
    EXPECT_FALSE(roster_.leave("a"));
}

} // namespace
} // namespace scanloom::session
