#include "server/sessions/session_cache.hpp"

#include "tests/unit/server/sessions/session_fixture.hpp"

#include <chrono>
#include <string>
#include <vector>

namespace scanloom::sessions {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Time = SessionCache::Clock::time_point;

Time at(int second) { return Time(std::chrono::seconds(second)); }

/// A session cache with sessions that have no scans and are referenced only by the cache.
class SessionCacheTest : public SessionTest {
protected:
    void add(const std::string& name, int second) {
        cache_.add(std::make_shared<Session>(SessionInfo{++last_id_, name, 0.0, config_}, mapping::Projection(config_),
                                             0, log_, compute_.get_executor()),
                   at(second));
    }

    void add_evicted(const std::string& name) {
        cache_.add(SessionInfo{++last_id_, name, 0.0, config_}, summary_of(mapping::Snapshot{}));
    }

    std::vector<std::string> evict(int second, std::size_t pages = 1) {
        std::vector<std::string> names;
        for (const auto& session : cache_.evict(at(second), pages)) names.push_back(session->info().name);
        return names;
    }

    /// Returns a callback that records the session's name or the error message.
    SessionCache::Loaded note(std::string caller) {
        return [this, caller = std::move(caller)](const Result<std::shared_ptr<Session>>& session) {
            notified_.push_back(caller + ": " +
                                (!session   ? session.error().message
                                 : *session ? (*session)->info().name
                                            : "none"));
        };
    }

    void expect_loaded(const std::string& name, bool loaded) {
        EXPECT_EQ(cache_.find(name, at(0)) != nullptr, loaded) << name;
        EXPECT_TRUE(cache_.contains(name)) << name;
    }

    store::SessionId last_id_ = 0;
    SessionCache cache_;
    std::vector<std::string> notified_;
};

TEST_F(SessionCacheTest, OneCallerLoadsAnEvictedSessionForAll) {
    add_evicted("a");
    const auto evicted = cache_.request("a", at(1), note("first"));
    ASSERT_TRUE(evicted);
    EXPECT_EQ(evicted->info.name, "a");
    EXPECT_FALSE(cache_.request("a", at(1), note("second")));
    EXPECT_THAT(notified_, IsEmpty());
    expect_loaded("a", false);
    cache_.end_load(
        std::make_shared<Session>(evicted->info, mapping::Projection(config_), 0, log_, compute_.get_executor()),
        at(2));
    EXPECT_THAT(notified_, ElementsAre("first: a", "second: a"));
    expect_loaded("a", true);
}

TEST_F(SessionCacheTest, AnEvictedSessionIsAddedOnlyIfItsNameIsNeitherReservedNorThere) {
    {
        const SessionCache::Reservation reserved(cache_, "a");
        add_evicted("a");
        EXPECT_FALSE(cache_.contains("a"));
        add("a", 1);
    }
    add_evicted("a");
    expect_loaded("a", true);
}

TEST_F(SessionCacheTest, FollowsTheListOfALogThatServersShare) {
    add("own", 1);
    const auto own = last_id_;
    add("lost", 1);
    const auto lost = last_id_;
    add("new", 10);
    add_evicted("kept");
    const auto kept = last_id_;
    add_evicted("gone");
    const auto node = std::make_shared<const store::NodeInfo>(store::NodeInfo{.name = "other"});
    const auto followed =
        cache_.follow({{own, {1, nullptr, true}}, {lost, {9, node}}, {kept, {5, node}}, {77, {1, nullptr}}}, at(10));
    EXPECT_THAT(followed.unknown, ElementsAre(77));
    ASSERT_EQ(followed.lost.size(), 1U);
    EXPECT_EQ(followed.lost[0]->info().name, "lost");
    expect_loaded("own", true);
    expect_loaded("lost", false);
    expect_loaded("new", true);
    EXPECT_EQ(cache_.owner("kept"), node);
    EXPECT_EQ(cache_.listed("kept")->shared.end, 5U);
    EXPECT_FALSE(cache_.contains("gone"));
    EXPECT_EQ(cache_.owner("own"), nullptr);
}

TEST_F(SessionCacheTest, EvictsLeastRecentlyUsedSessionsAndNoMoreThanNeeded) {
    add("older", 10);
    add("newer", 20);
    add("used", 5);
    ASSERT_TRUE(cache_.find("used", at(30)));
    EXPECT_THAT(evict(9), IsEmpty()) << "each session was used later";
    EXPECT_THAT(evict(25, 0), IsEmpty()) << "no pages are needed";
    EXPECT_THAT(evict(25), ElementsAre("older", "newer")) << "both sessions have no pages";
    expect_loaded("older", false);
    expect_loaded("used", true);
}

TEST_F(SessionCacheTest, CallerDuringEvictionGetsTheReloadedSession) {
    add("a", 0);
    ASSERT_THAT(evict(1), ElementsAre("a"));
    EXPECT_FALSE(cache_.request("a", at(2), note("late"))) << "the session is being evicted by another caller";
    const auto evicted = cache_.end_eviction("a", summary_of(mapping::Snapshot{}));
    ASSERT_TRUE(evicted) << "the caller must load the session";
    EXPECT_THAT(notified_, IsEmpty());
}

TEST_F(SessionCacheTest, EvictedSessionIsListedWithItsLastSummary) {
    add("a", 0);
    ASSERT_THAT(evict(1), ElementsAre("a"));
    mapping::Snapshot last{.revision = 7};
    last.robots.resize(2);
    EXPECT_FALSE(cache_.end_eviction("a", summary_of(last)));
    const auto listed = cache_.all();
    ASSERT_EQ(listed.size(), 1U);
    EXPECT_EQ(listed[0].session, nullptr);
    EXPECT_EQ(listed[0].summary.facts->revision, 7U);
    EXPECT_EQ(listed[0].summary.facts->robots.size(), 2U);
    EXPECT_THAT(cache_.loaded(), IsEmpty());
}

TEST_F(SessionCacheTest, WaitingCallerIsNotifiedOfRemoval) {
    add("a", 0);
    ASSERT_TRUE(cache_.begin_change("a"));
    EXPECT_FALSE(cache_.request("a", at(1), note("late")));
    cache_.remove("a", {Errc::kGone, "deleted"});
    EXPECT_THAT(notified_, ElementsAre("late: deleted"));
    EXPECT_FALSE(cache_.contains("a"));
    EXPECT_FALSE(cache_.begin_change("a"));
}

} // namespace
} // namespace scanloom::sessions
