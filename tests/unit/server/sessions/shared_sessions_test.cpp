#include "server/store/shared_sessions.hpp"

#include "tests/support/digests.hpp"
#include "tests/unit/server/sessions/registry_fixture.hpp"
#include "tests/unit/server/store/postgres_database.hpp"

#include <algorithm>
#include <array>
#include <thread>

/// Sessions of two servers that share a log in a database.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using namespace std::chrono_literals;

/// One of the servers.
struct Node {
    std::unique_ptr<store::ScanLog> log;
    std::unique_ptr<SessionRegistry> registry;
};

class SharedSessionsTest : public SessionRegistryTest {
protected:
    ~SharedSessionsTest() override {
        for (Node* node : {&a_, &b_}) {
            if (node->registry) node->registry->drain();
        }
        wait_for_posted_tasks();
    }

    Node start(const std::string& name) {
        Node node;
        node.log = store::open_postgres(database_.address, {.allow_unreplicated = true, .node = name}).value();
        EXPECT_TRUE(node.log->shared()->announce({.name = name, .robots = name + ":7447"}));
        node.registry = make(*node.log);
        EXPECT_TRUE(node.registry->recover());
        return node;
    }

    void stop(Node& node) {
        node.registry->drain();
        wait_for_posted_tasks();
        node.registry.reset();
        node.log.reset();
    }

    /// Creates a session with some scans on a node, where it stays in memory.
    /// @return the digest of its maps
    std::string create(Node& node, const std::string& name) {
        const auto session = node.registry->create(name, {}).value();
        session->leave(stream(*session, "r", 20));
        return digest(*session);
    }

    static std::string digest(const Session& session) { return testing_support::digests_of(*session.snapshot()); }

    /// Waits until a node has given up an unused session.
    void evict(Node& node, const std::string& name) {
        clock_ = clock_.load() + 1h;
        while (node.registry->listed(name)->session) {
            node.registry->tidy();
            std::this_thread::yield();
        }
    }

    store::PostgresDatabase database_;
    Node a_ = start("a");
    Node b_ = start("b");
};

TEST_F(SharedSessionsTest, ASessionIsOnOneServerAndMovesToAnotherWhenItIsEvicted) {
    const auto before = create(a_, "s");
    const auto refused = b_.registry->load("s");
    EXPECT_EQ(refused.error().code, Errc::kNotOwner);
    EXPECT_THAT(refused.error().message, HasSubstr("belongs to node a"));
    evict(a_, "s");
    const auto session = b_.registry->load("s").value();
    EXPECT_EQ(digest(*session), before);
    EXPECT_EQ(a_.registry->load("s").error().code, Errc::kNotOwner);
    const auto link = std::make_shared<AwaitedLink>();
    ASSERT_TRUE(join_and_wait(*session, "r", link));
    session->submit(link, small_laser(), 0);
    session->submit(link, {random_scan(7, 21)}, 0);
    link->wait_for_seq(21);
}

/// A link whose robot asks another server for the session as soon as it fails.
struct MovingLink : AwaitedLink {
    MovingLink(const Session& joined, Node& here, Node& other)
        : session(joined.info()), registry(*here.registry), log(*other.log) {}

    void on_failed(const Error& error) override {
        if (const auto server = registry.successor(session.name)) successor = server->name;
        taken = store::own(log, session.id);
        AwaitedLink::on_failed(error);
    }

    SessionInfo session;
    SessionRegistry& registry;
    store::ScanLog& log;
    std::string successor;
    Result<> taken;
};

TEST_F(SharedSessionsTest, AServerThatDrainsLeavesAllItsSessionsToOthersAlsoInAHurry) {
    for (const bool in_a_hurry : {false, true}) {
        auto c = start("c");
        std::vector<std::string> names;
        for (int n = 0; n < 10; ++n) names.push_back((in_a_hurry ? "hurry" : "calm") + std::to_string(n));
        for (const auto& name : names) create(c, name);
        if (in_a_hurry) c.registry->finish_early();
        stop(c);
        for (const auto& name : names) EXPECT_EQ(b_.registry->load(name).value()->snapshot()->revision, 22U);
    }
}

TEST_F(SharedSessionsTest, AServerThatDrainsSendsRobotsToTheServerWithTheFewestSessions) {
    const auto before = create(a_, "s");
    create(b_, "t");
    auto c = start("c");
    a_.registry->tidy(); // now it knows the others
    const auto session = a_.registry->find("s");
    const auto link = std::make_shared<MovingLink>(*session, a_, c);
    ASSERT_TRUE(join_and_wait(*session, "other", link));
    stop(a_);
    EXPECT_EQ(link->wait_for_failure().code, Errc::kNotOwner);
    EXPECT_EQ(link->successor, "c");
    EXPECT_TRUE(link->taken) << "it was given up before robots left";
    EXPECT_EQ(digest(*c.registry->load("s").value()), before);
    stop(c);
}

/// As after a pause of the first server, in which it counts as dead.
TEST_F(SharedSessionsTest, AServerThatLostASessionChangesNothingAndSendsItsRobotsAway) {
    const auto before = create(a_, "s");
    static_cast<void>(database_.run("UPDATE scanloom.session SET owner = 0"));
    const auto taken = b_.registry->load("s").value();
    EXPECT_EQ(digest(*taken), before) << "what was acknowledged is there";

    const auto lost = a_.registry->find("s");
    const auto joined = join_and_wait(*lost, "other", std::make_shared<AwaitedLink>());
    EXPECT_EQ(joined.error().code, Errc::kNotOwner);
    a_.registry->tidy();
    EXPECT_EQ(a_.registry->load("s").error().code, Errc::kNotOwner);
    EXPECT_EQ(a_.registry->find("s"), nullptr);
    EXPECT_EQ(taken->snapshot()->robots.size(), 1U);
    EXPECT_TRUE(a_.registry->create("t", {})) << "the other sessions of the server go on";
}

/// No robot uses it there, so that no append would fail.
TEST_F(SharedSessionsTest, AServerThatLostASessionDoesNotShowItAnyLonger) {
    create(a_, "s");
    const auto lost = a_.registry->find("s");
    EXPECT_TRUE(a_.registry->confirm(*lost));
    static_cast<void>(database_.run("UPDATE scanloom.session SET owner = 0"));
    ASSERT_TRUE(b_.registry->load("s"));
    EXPECT_EQ(a_.registry->confirm(*lost).error().code, Errc::kNotOwner);
    clock_ = clock_.load() + 1s;
    while (a_.registry->find("s")) a_.registry->tidy();
    EXPECT_EQ(a_.registry->load("s").error().code, Errc::kNotOwner);
    EXPECT_EQ(a_.registry->owner("s")->name, "b");
}

TEST_F(SharedSessionsTest, NothingIsLoadedAtTheStart) {
    create(a_, "s");
    auto c = start("c");
    EXPECT_THAT(c.registry->list(), IsEmpty());
    const auto listed = c.registry->listed("s").value();
    EXPECT_EQ(listed.summary.facts->revision, a_.registry->find("s")->snapshot()->revision);
    stop(c);
}

TEST_F(SharedSessionsTest, TheListFollowsWhatOthersCreateAndRemove) {
    create(a_, "s");
    EXPECT_THAT(b_.registry->all(), IsEmpty());
    b_.registry->tidy();
    ASSERT_THAT(b_.registry->all(), SizeIs(1));
    EXPECT_EQ(b_.registry->remove("s").error().code, Errc::kNotOwner);
    ASSERT_TRUE(a_.registry->remove("s"));
    b_.registry->tidy();
    EXPECT_THAT(b_.registry->all(), IsEmpty());
    create(a_, "s");
    EXPECT_EQ(b_.registry->load("s").error().code, Errc::kNotOwner) << "found without the list";
    EXPECT_EQ(b_.registry->load("t").error().code, Errc::kNotFound);
}

TEST_F(SharedSessionsTest, AServerRemovesASessionThatItHasNeverSeen) {
    create(a_, "s");
    evict(a_, "s");
    EXPECT_TRUE(b_.registry->remove("s"));
    EXPECT_EQ(a_.registry->load("s").error().code, Errc::kNotFound);
    EXPECT_THAT(a_.registry->all(), IsEmpty());
}

TEST_F(SharedSessionsTest, ExclusionsContinueThoseOfTheOtherServer) {
    create(a_, "s");
    b_.registry->tidy(); // knows the session without exclusions from now on
    ASSERT_TRUE(a_.registry->exclude("s", 0, SeqRange{1, 2}));
    EXPECT_EQ(b_.registry->exclude("s", 0, SeqRange{3, 4}).error().code, Errc::kNotOwner);
    static_cast<void>(a_.registry->load("s"));
    evict(a_, "s");
    EXPECT_EQ(b_.registry->exclude("s", 0, SeqRange{3, 4}).value().excluded.id, 2U);
}

/// Robots that create the same session on two servers at once, while others ask for it.
TEST_F(SharedSessionsTest, OneOfTwoServersCreatesASession) {
    for (int n = 0; n < 20; ++n) {
        const auto name = "s" + std::to_string(n);
        std::atomic<int> created = 0;
        {
            std::array<std::jthread, 4> threads;
            for (std::size_t t = 0; t < threads.size(); ++t) {
                threads[t] = std::jthread([&, t] {
                    auto& registry = *(t % 2 == 0 ? a_ : b_).registry;
                    if (t >= 2) { // until the session is where it is looked for, or on the other server
                        while (created == 0) static_cast<void>(registry.load(name));
                        return;
                    }
                    const auto session = registry.create(name, {});
                    created += session ? 1 : 0;
                    EXPECT_EQ(session ? registry.find(name) : nullptr, session ? *session : nullptr);
                    EXPECT_TRUE(session || session.error().code == Errc::kAlreadyExists);
                });
            }
        }
        EXPECT_EQ(created, 1);
    }
}

} // namespace
} // namespace scanloom::sessions
