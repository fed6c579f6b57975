#include "common/wire/log_codec.hpp"
#include "tests/support/digests.hpp"
#include "tests/unit/server/sessions/registry_fixture.hpp"

#include <thread>

namespace scanloom::sessions {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

std::vector<std::string> names_of(const std::vector<ListedSession>& sessions) {
    std::vector<std::string> names;
    for (const auto& listed : sessions) names.push_back(listed.info.name);
    return names;
}

TEST_F(SessionRegistryTest, CreatedSessionIsFoundAndListedByName) {
    const auto b = registry_->create("b", {.cell_size = 0.1});
    ASSERT_TRUE(b);
    ASSERT_TRUE(registry_->create("a", {}));
    EXPECT_EQ(registry_->find("b"), *b);
    EXPECT_EQ(registry_->find("c"), nullptr);
    EXPECT_THAT(names_of(registry_->all()), ElementsAre("a", "b"));
    EXPECT_EQ((*b)->info().config.cell_size, 0.1);
    EXPECT_EQ((*b)->info().created, 1000.5);
}

TEST_F(SessionRegistryTest, NamesAreUnique) {
    ASSERT_TRUE(registry_->create("a", {}));
    const auto again = registry_->create("a", {});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, Errc::kAlreadyExists);
    EXPECT_THAT(log_.sessions().value(), SizeIs(1));
}

TEST_F(SessionRegistryTest, MakersLimitsApplyAfterARestart) {
    const Creator creator{"depot", 2, 4};
    ASSERT_TRUE(registry_->create("a", {}, creator));
    ASSERT_TRUE(registry_->create("b", {}, creator));
    ASSERT_TRUE(registry_->create("c", {})); // without a creator
    ASSERT_TRUE(registry_->create("d", {}, {"other", 1}));
    registry_->drain();
    restart();
    EXPECT_EQ(registry_->info("a")->created_by, "depot");
    EXPECT_EQ(registry_->info("c")->created_by, "");
    const auto refused = registry_->create("e", {}, creator);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kFull);
    EXPECT_THAT(refused.error().message, AllOf(HasSubstr("'depot'"), HasSubstr("`sessions`")));

    const auto link = std::make_shared<AwaitedLink>();
    const auto loaded = registry_->load("a").value();
    auto& small = *loaded;
    ASSERT_TRUE(join_and_wait(small, "r", link));
    small.submit(link, small_laser(), 0);
    small.submit(link, {random_scan(7, 1)}, 0);
    const auto full = link->wait_for_failure();
    EXPECT_EQ(full.code, Errc::kFull);
    EXPECT_THAT(full.message, AllOf(HasSubstr("beyond 4"), HasSubstr("`cells`"), HasSubstr("'depot'")));

    ASSERT_TRUE(registry_->remove("b"));
    EXPECT_TRUE(registry_->create("e", {}, creator));
}

TEST_F(SessionRegistryTest, InvalidNamesAndSettingsAreRefusedByField) {
    for (const char* name : {"", "a/b", "../a", "caf\xc3\xa9"}) {
        const auto refused = registry_->create(name, {});
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().code, Errc::kInvalidField);
        EXPECT_THAT(refused.error().message, StartsWith("name is not a valid session name"));
    }
    for (const double cell_size : {0.0, -1.0, 1e-9, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
        const auto refused = registry_->create("a", {.cell_size = cell_size});
        ASSERT_FALSE(refused) << cell_size;
        EXPECT_EQ(refused.error().code, Errc::kInvalidField);
        EXPECT_THAT(refused.error().message, StartsWith("cell_size is "));
    }
    EXPECT_THAT(registry_->all(), IsEmpty());
    EXPECT_THAT(log_.sessions().value(), IsEmpty());
}

TEST_F(SessionRegistryTest, SessionRefusedByTheStoreIsNotCreated) {
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    const auto refused = registry_->create("a", {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kStoreFailed);
    EXPECT_EQ(registry_->find("a"), nullptr);
}

TEST_F(SessionRegistryTest, EverySessionIsRecoveredAfterARestart) {
    std::map<std::string, std::string> digests;
    for (int n = 0; n < 12; ++n) {
        const auto name = "s" + std::to_string(n);
        const auto session = registry_->create(name, {.cell_size = 0.05 + 0.01 * n}).value();
        stream(*session, "r", static_cast<std::size_t>(5 * n));
        digests[name] = testing_support::digests_of(*session->snapshot());
    }
    registry_->drain();
    restart();
    ASSERT_THAT(registry_->all(), SizeIs(12));
    for (const auto& [name, digest] : digests) {
        const auto session = registry_->load(name).value();
        EXPECT_EQ(testing_support::digests_of(*session->snapshot()), digest);
        EXPECT_EQ(session->info().created, 1000.5);
    }
    EXPECT_DOUBLE_EQ(registry_->find("s3")->info().config.cell_size, 0.05 + 0.01 * 3);
    const auto joined = join_and_wait(*registry_->find("s3"), "r", std::make_shared<AwaitedLink>());
    EXPECT_EQ(joined->last_durable_seq, 15U);
    registry_->drain();
}

TEST_F(SessionRegistryTest, DamagedSessionIsReportedAndOthersAreServed) {
    ASSERT_TRUE(registry_->create("before", {}));
    const auto bad = registry_->create("bad", {}).value();
    ASSERT_TRUE(registry_->create("after", {}));
    ASSERT_TRUE(store::append_and_wait(log_, bad->info().id, 1, {"no entry"}));
    ASSERT_TRUE(log_.create_session("no record"));
    restart();
    EXPECT_THAT(names_of(registry_->all()), ElementsAre("after", "before"));
    const auto damaged = registry_->damaged();
    ASSERT_THAT(damaged, SizeIs(2));
    EXPECT_THAT(damaged.at("bad").message, HasSubstr("log entry 1: "));
    EXPECT_THAT(damaged.at("#4").message, HasSubstr("a session in the store cannot be read"));

    const auto again = registry_->create("bad", {});
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("exists but is damaged"));
    ASSERT_TRUE(registry_->remove("bad"));
    EXPECT_TRUE(registry_->create("bad", {}));
    ASSERT_TRUE(registry_->remove("#4"));
    EXPECT_THAT(registry_->damaged(), IsEmpty());
}

TEST_F(SessionRegistryTest, OlderOfTwoSessionsOfOneNameIsServed) {
    const auto first = registry_->create("twin", {}).value();
    stream(*first, "r", 3);
    registry_->drain();
    ASSERT_TRUE(log_.create_session(wire::encode_session({"twin", 2000.0, {}})));
    restart();
    EXPECT_THAT(names_of(registry_->all()), ElementsAre("twin"));
    EXPECT_EQ(registry_->info("twin")->id, first->info().id);
    ASSERT_THAT(registry_->damaged(), SizeIs(1));
    EXPECT_THAT(registry_->damaged().at("twin#2").message, HasSubstr("a second session 'twin'"));
    ASSERT_TRUE(registry_->remove("twin#2"));
    EXPECT_THAT(registry_->damaged(), IsEmpty());
    EXPECT_THAT(log_.sessions().value(), SizeIs(1));
    registry_->drain();
}

TEST_F(SessionRegistryTest, RemovedSessionIsDeletedFromTheStore) {
    const auto session = registry_->create("a", {}).value();
    stream(*session, "r", 10);
    ASSERT_TRUE(registry_->remove("a"));
    EXPECT_EQ(registry_->find("a"), nullptr);
    EXPECT_THAT(log_.sessions().value(), IsEmpty());
    EXPECT_EQ(session->snapshot()->robots[0].last_seq, 10U) << "the snapshot of a held session stays readable";
    const auto again = registry_->remove("a");
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, Errc::kNotFound);
    EXPECT_NE(registry_->create("a", {}).value()->info().id, session->info().id);
}

TEST_F(SessionRegistryTest, RemovalFailsStreamingRobotsAndAffectsNoOthers) {
    const auto removed = registry_->create("removed", {}).value();
    const auto other = registry_->create("other", {}).value();
    const auto link = stream(*removed, "r", 1);
    std::atomic<bool> stop = false;
    std::thread robot([&] {
        for (std::uint64_t seq = 2; !stop; ++seq) removed->submit(link, {random_scan(7, seq)}, 0);
    });
    ASSERT_TRUE(registry_->remove("removed"));
    EXPECT_EQ(link->wait_for_failure().code, Errc::kGone);
    stop = true;
    robot.join();
    stream(*other, "r", 20);
    EXPECT_EQ(join_and_wait(*removed, "r", std::make_shared<AwaitedLink>()).error().code, Errc::kGone);
}

TEST_F(SessionRegistryTest, OneComputeThreadSufficesToRecoverRemoveAndDrain) {
    stream(*registry_->create("a", {}).value(), "r", 10);
    stream(*registry_->create("b", {}).value(), "r", 10);
    boost::asio::thread_pool one_thread(1);
    SessionRegistry registry(log_, {one_thread.get_executor(), [] { return 0.0; }});
    ASSERT_TRUE(registry.recover());
    const auto link = std::make_shared<AwaitedLink>();
    ASSERT_TRUE(join_and_wait(*registry.find("a"), "r", link));
    registry.find("a")->submit(link, random_scans(7, 11, 500), 0);
    ASSERT_TRUE(registry.remove("a"));
    EXPECT_EQ(link->wait_for_failure().code, Errc::kGone);
    registry.drain();
    one_thread.join();
}

TEST_F(SessionRegistryTest, DrainingMakesEntriesDurableAndRefusesNewOnes) {
    std::vector<std::shared_ptr<AwaitedLink>> links;
    for (int n = 0; n < 5; ++n) {
        const auto session = registry_->create("s" + std::to_string(n), {}).value();
        links.push_back(stream(*session, "r", 1));
        session->submit(links.back(), random_scans(7, 2, 30), 0);
    }
    EXPECT_FALSE(registry_->is_draining());
    registry_->drain();
    EXPECT_TRUE(registry_->is_draining());
    for (const auto& link : links) {
        EXPECT_EQ(link->durable_seq, 31U);
        EXPECT_EQ(link->wait_for_failure().code, Errc::kShuttingDown);
    }
    EXPECT_EQ(registry_->create("late", {}).error().code, Errc::kShuttingDown);
    registry_->drain();
    ASSERT_TRUE(registry_->remove("s0")) << "drained sessions can still be deleted";
}

/// A log whose read() waits before a given entry.
class GatedLog : public store::MemoryScanLog {
public:
    Result<> read(store::SessionId session, Revision after, const VisitEntry& visit) override {
        return MemoryScanLog::read(session, after, [&](Revision revision, std::string_view entry) {
            if (revision == gate) {
                reached.set_value();
                opened.get_future().wait();
            }
            return visit(revision, entry);
        });
    }

    Revision gate = 0; // 0 means none
    std::promise<void> reached;
    std::promise<void> opened;
};

/// A registry that is stopped during the recovery of a session with 60 scans, after 30 of them.
class StoppedRecoveryTest : public SessionRegistryTest {
protected:
    void SetUp() override {
        SessionRegistry first(gated_, {compute_.get_executor(), [] { return 0.0; }});
        const auto session = first.create("lab", {}).value();
        stream(*session, "r", 60);
        id_ = session->info().id;
        digest_ = testing_support::digests_of(*session->snapshot());
    }

    void stop_in_the_middle(bool early) {
        gated_.gate = 32;
        SessionRegistry registry(gated_, {compute_.get_executor(), [] { return 0.0; }});
        std::atomic<bool> recovered = false;
        std::thread recovering([&] {
            EXPECT_TRUE(registry.recover());
            recovered = true;
        });
        gated_.reached.get_future().wait();
        std::thread draining([&] {
            registry.drain();
            EXPECT_TRUE(recovered || registry.list().empty()) << "drain() must wait for recover()";
        });
        while (!registry.is_draining()) std::this_thread::yield();
        if (early) registry.finish_early();
        gated_.opened.set_value();
        recovering.join();
        draining.join();
        gated_.gate = 0;
        EXPECT_TRUE(registry.list().empty());
        EXPECT_TRUE(registry.damaged().empty());
    }

    void expect_that_the_next_start_has_everything() {
        SessionRegistry next(gated_, {compute_.get_executor(), [] { return 0.0; }});
        ASSERT_TRUE(next.recover());
        ASSERT_TRUE(next.find("lab"));
        EXPECT_EQ(testing_support::digests_of(*next.find("lab")->snapshot()), digest_);
    }

    GatedLog gated_;
    store::SessionId id_ = 0;
    std::string digest_;
};

TEST_F(StoppedRecoveryTest, WritesACheckpointOfTheRecoveredEntries) {
    stop_in_the_middle(false);
    EXPECT_EQ(recover(gated_, id_, {}, false)->checkpointed, 31U);
    expect_that_the_next_start_has_everything();
}

TEST_F(StoppedRecoveryTest, HurryWritesNoCheckpoint) {
    stop_in_the_middle(true);
    EXPECT_THAT(store::checkpoint_of(gated_, id_).value(), IsEmpty());
    expect_that_the_next_start_has_everything();
}

TEST_F(SessionRegistryTest, ManyThreadsCanCreateAndRemoveTheSameNames) {
    std::vector<std::thread> threads;
    std::atomic<int> created = 0;
    std::atomic<int> removed = 0;
    for (int thread = 0; thread < 4; ++thread) {
        threads.emplace_back([&] {
            for (int n = 0; n < 50; ++n) {
                const auto name = "s" + std::to_string(n % 3);
                if (registry_->create(name, {})) ++created;
                if (registry_->remove(name)) ++removed;
            }
        });
    }
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(static_cast<std::size_t>(created - removed), registry_->all().size());
    EXPECT_EQ(registry_->all().size(), log_.sessions()->size());
}

} // namespace
} // namespace scanloom::sessions
