#include "core/mapping/reach.hpp"
#include "tests/support/digests.hpp"
#include "tests/unit/server/sessions/registry_fixture.hpp"

#include <algorithm>
#include <thread>

/// Sessions that are evicted from memory and loaded again.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using namespace std::chrono_literals;

class EvictedSessions : public SessionRegistryTest {
protected:
    ~EvictedSessions() override { registry_->drain(); }

    /// Creates a session with some scans and leaves it unused.
    /// @return digests of its maps
    std::string create_unused(const std::string& name, std::size_t scans = 20) {
        const auto session = registry_->create(name, {}).value();
        const auto link = stream(*session, "r", scans);
        session->leave(link);
        return testing_support::digests_of(*session->snapshot());
    }

    /// Advances the clock and waits until the sessions `names` are evicted.
    void evict(const std::vector<std::string>& names) {
        clock_ = clock_.load() + 1h;
        for (const auto& name : names) {
            while (is_loaded(name)) {
                registry_->tidy();
                std::this_thread::yield();
            }
        }
    }

    /// Returns whether the session is loaded or being evicted. This call does not use the session.
    bool is_loaded(const std::string& name) { return registry_->listed(name)->session != nullptr; }

    /// Loads a session; the clock advances by `passing` between two checks of callers that wait for memory.
    Result<std::shared_ptr<Session>> load(const std::string& name, std::chrono::seconds passing) {
        const auto promise = std::make_shared<std::promise<Result<std::shared_ptr<Session>>>>();
        auto loaded = promise->get_future();
        registry_->load(name, [promise](auto session) { promise->set_value(std::move(session)); });
        while (loaded.wait_for(0s) != std::future_status::ready) {
            clock_ = clock_.load() + passing;
            registry_->tidy();
            std::this_thread::yield();
        }
        return loaded.get();
    }

    std::string digest_after_loading(const std::string& name) {
        const auto session = load(name, 0s);
        EXPECT_TRUE(session) << session.error().message;
        return session ? testing_support::digests_of(*(*session)->snapshot()) : "";
    }

    /// Expects that only one session is listed, with the facts that its maps had.
    void expect_listed_as(const mapping::Snapshot& maps) {
        const auto listed = registry_->all();
        ASSERT_THAT(listed, SizeIs(1));
        const auto& facts = *listed[0].summary.facts;
        EXPECT_EQ(facts.revision, maps.revision);
        EXPECT_EQ(facts.bounds, maps.bounds);
        ASSERT_THAT(facts.robots, SizeIs(1));
        EXPECT_EQ(facts.robots[0].name, "r");
        EXPECT_EQ(facts.robots[0].scan_count, 7U);
        EXPECT_EQ(facts.robots[0].last_seq, 7U);
        EXPECT_EQ(facts.robots[0].pose, maps.robots[0].pose);
        EXPECT_EQ(facts.robots[0].stamp, maps.robots[0].stamp);
    }
};

TEST_F(EvictedSessions, AreEqualAfterLoading) {
    const auto digest = create_unused("a");
    evict({"a"});
    EXPECT_THAT(registry_->list(), IsEmpty());
    EXPECT_EQ(registry_->pages().used(), 0);
    EXPECT_EQ(digest_after_loading("a"), digest);
    const auto session = registry_->find("a");
    ASSERT_TRUE(session);
    EXPECT_EQ(join_and_wait(*session, "r", std::make_shared<AwaitedLink>())->last_durable_seq, 20U);
}

TEST_F(EvictedSessions, AreListedWithTheirLastSummary) {
    create_unused("a", 7);
    const auto before = registry_->load("a").value()->snapshot();
    evict({"a"});
    expect_listed_as(*before);
}

TEST_F(EvictedSessions, AreListedAfterARestartWithoutLoading) {
    const auto digest = create_unused("a", 7);
    const auto before = registry_->load("a").value()->snapshot();
    registry_->drain();
    restart();
    EXPECT_THAT(registry_->list(), IsEmpty());
    expect_listed_as(*before);
    const auto listed = registry_->all();
    EXPECT_GT(listed[0].summary.pages, 0U);
    EXPECT_EQ(digest_after_loading("a"), digest);
    EXPECT_EQ(registry_->pages().used(), static_cast<std::int64_t>(listed[0].summary.pages));
}

TEST_F(EvictedSessions, LogBeyondTheCheckpointIsAppliedAtTheStart) {
    const auto digest = create_unused("a");
    restart(); // without closing, as after a crash
    EXPECT_THAT(registry_->list(), SizeIs(1));
    EXPECT_EQ(testing_support::digests_of(*registry_->find("a")->snapshot()), digest);
}

TEST_F(EvictedSessions, UsedSessionsAreNotEvicted) {
    create_unused("a");
    const auto session = registry_->create("b", {}).value();
    const auto link = stream(*session, "r", 3);
    evict({"a"});
    EXPECT_EQ(registry_->find("b"), session);
    session->submit(link, {random_scan(7, 4)}, 0);
    link->wait_for_seq(4);
}

TEST_F(EvictedSessions, AreEvictedWhenOthersNeedMemory) {
    const auto digest = create_unused("a");
    const auto pages = registry_->pages().used();
    std::int64_t of_a_scan = 0; // upper bound per scan
    for (std::uint64_t seq = 1; seq <= 20; ++seq) {
        const auto reach = mapping::reach_of({}, small_laser(), random_scan(7, seq));
        of_a_scan = std::max(of_a_scan, mapping::chunk_count_of(reach.cells));
    }
    registry_->drain();
    restart(static_cast<std::size_t>(pages + of_a_scan + 1));
    EXPECT_EQ(digest_after_loading("a"), digest);
    const auto b = registry_->create("b", {}).value();
    auto link = std::make_shared<AwaitedLink>();
    for (std::uint64_t sent = 0; sent < 20;) { // scans are refused while memory is short, and robots reconnect
        const auto joined = join_and_wait(*b, "r", link);
        ASSERT_TRUE(joined) << joined.error().message;
        sent = joined->last_durable_seq;
        b->submit(link, small_laser(), 0);
        for (std::uint64_t seq = sent + 1; seq <= 20; ++seq) b->submit(link, {random_scan(7, seq)}, 0);
        if (!link->wait_for_seq_or_failure(20))
            link = std::make_shared<AwaitedLink>();
        else
            sent = 20;
    }
    EXPECT_EQ(testing_support::digests_of(*b->snapshot()), digest) << "both sessions have equal scans";
    EXPECT_FALSE(registry_->listed("a")->session);
    EXPECT_LE(registry_->pages().used(), registry_->pages().total());
}

TEST_F(EvictedSessions, AreNotLoadedWhileUsedSessionsNeedAllMemory) {
    const auto digest_of_a = create_unused("a");
    const auto digest_of_b = create_unused("b");
    const auto pages = static_cast<std::size_t>(registry_->pages().used()) / 2;
    registry_->drain();
    restart(pages + pages / 2);
    auto held = registry_->load("a");
    ASSERT_TRUE(held);
    const auto refused = load("b", 1s);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kOverloaded);
    EXPECT_THAT(refused.error().message, HasSubstr("--map-memory"));
    EXPECT_THAT(registry_->damaged(), IsEmpty());
    held = Error{Errc::kGone, "released"};
    EXPECT_EQ(digest_after_loading("b"), digest_of_b);
    EXPECT_EQ(digest_after_loading("a"), digest_of_a);
    EXPECT_LE(registry_->pages().used(), registry_->pages().total());
}

TEST_F(EvictedSessions, RecoveryAfterACrashStaysWithinTheMemoryBudget) {
    std::vector<std::string> digests;
    for (int n = 0; n < 6; ++n)
        digests.push_back(create_unused("s" + std::to_string(n), 20 + 5 * static_cast<std::size_t>(n)));
    const auto pages = static_cast<std::size_t>(registry_->pages().used()) / 6;
    restart(2 * pages);
    EXPECT_LE(registry_->pages().used(), registry_->pages().total());
    EXPECT_THAT(registry_->all(), SizeIs(6));
    for (int n = 0; n < 6; ++n)
        EXPECT_EQ(digest_after_loading("s" + std::to_string(n)), digests[static_cast<std::size_t>(n)]);
}

TEST_F(EvictedSessions, DamagedSessionIsReportedWhenLoaded) {
    create_unused("a");
    evict({"a"});
    const auto id = registry_->info("a")->id;
    ASSERT_TRUE(log_.write_checkpoint(id, {{"format", "damaged"}}));
    ASSERT_TRUE(store::append_and_wait(log_, id, 23, {"no entry"}));
    const auto refused = registry_->load("a");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("log entry 23"));
    ASSERT_THAT(registry_->damaged(), SizeIs(1));
    EXPECT_THAT(registry_->all(), IsEmpty());
    EXPECT_EQ(registry_->load("a").error(), refused.error());
    EXPECT_EQ(registry_->pages().used(), 0);
    EXPECT_TRUE(registry_->remove("a"));
    EXPECT_EQ(registry_->load("a").error().code, Errc::kNotFound);
}

TEST_F(EvictedSessions, ReadErrorIsNotReportedAsDamage) {
    const auto digest = create_unused("a");
    evict({"a"});
    log_.fail_reading(Error{Errc::kStoreFailed, "input/output error"});
    EXPECT_EQ(registry_->load("a").error(), (Error{Errc::kStoreFailed, "input/output error"}));
    EXPECT_THAT(registry_->damaged(), IsEmpty());
    EXPECT_THAT(registry_->all(), SizeIs(1));
    log_.fail_reading({});
    EXPECT_EQ(digest_after_loading("a"), digest);
}

TEST_F(EvictedSessions, ReadErrorAtTheStartIsReportedUntilARestart) {
    const auto digest = create_unused("a");
    registry_->drain();
    log_.fail_reading(Error{Errc::kStoreFailed, "input/output error"});
    restart();
    const auto refused = registry_->load("a").error();
    EXPECT_EQ(refused.code, Errc::kDataLoss) << "the error is permanent";
    EXPECT_THAT(refused.message, HasSubstr("input/output error; if its disk is readable again, restart the server"));
    EXPECT_THAT(registry_->damaged(), SizeIs(1));
    log_.fail_reading({});
    restart();
    EXPECT_EQ(digest_after_loading("a"), digest);
}

TEST_F(EvictedSessions, CanBeRemoved) {
    create_unused("a");
    evict({"a"});
    ASSERT_TRUE(registry_->remove("a"));
    EXPECT_THAT(registry_->all(), IsEmpty());
    EXPECT_THAT(log_.sessions().value(), IsEmpty());
}

TEST_F(EvictedSessions, AreReloadedWhenTheStoreRecovers) {
    create_unused("a");
    const auto session = registry_->load("a").value();
    const auto link = std::make_shared<AwaitedLink>();
    ASSERT_TRUE(join_and_wait(*session, "r", link));
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    session->submit(link, {random_scan(7, 21)}, 0);
    EXPECT_THAT(link->wait_for_failure().message, HasSubstr("no space left"));
    registry_->tidy();
    EXPECT_EQ(registry_->find("a"), session) << "the maps are served until the store accepts changes";
    log_.reopen();
    registry_->tidy();
    const auto again = registry_->load("a");
    ASSERT_TRUE(again);
    EXPECT_NE(*again, session);
    EXPECT_FALSE((*again)->failure());
    EXPECT_EQ(session->closing()->code, Errc::kShuttingDown) << "watchers must reconnect";
    const auto next = std::make_shared<AwaitedLink>();
    EXPECT_EQ(join_and_wait(**again, "r", next)->last_durable_seq, 20U);
    (*again)->submit(next, {random_scan(7, 21)}, 0);
    next->wait_for_seq(21);
}

TEST_F(EvictedSessions, CanBeLoadedByManyThreadsDuringEviction) {
    const auto digest = create_unused("a");
    std::atomic<bool> stop = false;
    std::thread tidying([&] {
        while (!stop) {
            clock_ = clock_.load() + 1h;
            registry_->tidy();
        }
    });
    std::vector<std::thread> using_it;
    for (int n = 0; n < 4; ++n) {
        using_it.emplace_back([&] {
            for (int time = 0; time < 50; ++time) {
                const auto session = registry_->load("a");
                ASSERT_TRUE(session) << session.error().message;
                ASSERT_EQ((*session)->snapshot()->robots.at(0).last_seq, 20U);
            }
        });
    }
    for (auto& thread : using_it) thread.join();
    stop = true;
    tidying.join();
    EXPECT_EQ(digest_after_loading("a"), digest);
}

} // namespace
} // namespace scanloom::sessions
