#include "server/session/published.hpp"

#include "tests/unit/server/session/session_fixture.hpp"

#include <atomic>
#include <future>
#include <map>
#include <thread>

/// Maps that are written while others look.
namespace scanloom::session {
namespace {

std::shared_ptr<const mapping::Snapshot> maps_at(Revision revision) {
    return std::make_shared<const mapping::Snapshot>(mapping::Snapshot{.revision = revision});
}

TEST(Published, MapsThatSomebodyHoldsAreNotTakenBack) {
    Published published;
    published.set(maps_at(1));
    {
        const auto held = published.get();
        EXPECT_FALSE(published.take_back());
        EXPECT_EQ(published.get(), held);
    }
    EXPECT_TRUE(published.take_back());
}

TEST(Published, WhoeverAsksForMapsThatWereTakenBackWaitsForTheNext) {
    Published published;
    for (Revision revision = 1; revision <= 500; ++revision) {
        published.set(maps_at(revision));
        ASSERT_TRUE(published.take_back());
        Revision seen = 0;
        std::thread reader([&] { seen = published.get()->revision; });
        published.set(maps_at(revision + 1));
        reader.join();
        ASSERT_EQ(seen, revision + 1);
    }
}

TEST(Published, MapsThatSomebodyWaitsForAreNotTakenBackBeforeTheyAreThere) {
    Published published;
    published.set(maps_at(1));
    for (Revision revision = 2; revision <= 200; ++revision) {
        ASSERT_TRUE(published.take_back());
        std::promise<void> let_go;
        Revision seen = 0;
        std::thread reader([&] {
            const auto maps = published.get();
            seen = maps->revision;
            let_go.get_future().wait();
        });
        while (!published.is_waited_for()) std::this_thread::yield();
        published.set(maps_at(revision));
        EXPECT_FALSE(published.take_back()) << "the reader is on its way, or has them";
        let_go.set_value();
        reader.join();
        ASSERT_EQ(seen, revision);
    }
}

TEST(Published, WhoeverMayNotWaitHearsThatTheMapsWereTakenBack) {
    Published published;
    published.set(maps_at(1));
    EXPECT_EQ(published.try_get()->revision, 1U);
    ASSERT_TRUE(published.take_back());
    EXPECT_EQ(published.try_get(), nullptr);
    published.set(maps_at(2));
    EXPECT_EQ(published.try_get()->revision, 2U);
}

TEST(Published, OthersTakeThePlaceOfMapsThatWereTakenBackOnly) {
    Published published;
    published.set(maps_at(1));
    published.fall_back_to(maps_at(7));
    EXPECT_EQ(published.get()->revision, 1U);
    ASSERT_TRUE(published.take_back());
    published.fall_back_to(maps_at(7));
    EXPECT_EQ(published.get()->revision, 7U);
}

const mapping::LaserChunk* chunk_at_origin(const mapping::Snapshot& maps) { return maps.laser.find({0, 0}); }

TEST_F(SessionTest, WhatNobodyLooksAtIsWovenInPlace) {
    const auto link = join("r");
    auto scans = random_scans(1, 1, 3);
    for (auto& scan : scans) scan.pose = {};
    session_->submit(link, {scans[0]}, 10);
    run();
    const auto* chunk = chunk_at_origin(*session_->snapshot());
    ASSERT_NE(chunk, nullptr);
    session_->submit(link, {scans[1]}, 10);
    run();
    EXPECT_EQ(chunk_at_origin(*session_->snapshot()), chunk);

    const auto held = session_->snapshot();
    const auto before = testing_support::digests_of(*held);
    session_->submit(link, {scans[2]}, 10);
    run();
    EXPECT_NE(chunk_at_origin(*session_->snapshot()), chunk) << "somebody looks at it";
    EXPECT_EQ(testing_support::digests_of(*held), before);
    EXPECT_EQ(digest(), digest_of_log());
}

/// Takes the newest maps again and again, and what they hold, by revision.
class Looker {
public:
    explicit Looker(std::shared_ptr<Session> session) : thread_([this, session] { look(*session); }) {}

    [[nodiscard]] std::map<Revision, std::string> seen() {
        done_ = true;
        thread_.join();
        return std::move(seen_);
    }

private:
    void look(const Session& session) {
        for (Revision newest = 0; !done_;) {
            const auto maps = session.snapshot();
            EXPECT_GE(maps->revision, newest) << "maps come in order";
            newest = maps->revision;
            if (seen_.size() < 40) seen_.try_emplace(newest, testing_support::digests_of(*maps));
        }
    }

    std::map<Revision, std::string> seen_;
    std::atomic<bool> done_ = false;
    std::thread thread_;
};

TEST_F(SessionTest, WhoeverLooksWhileScansAreWovenSeesWholeMaps) {
    const auto link = join("r");
    Looker one(session_);
    Looker other(session_);
    for (std::uint64_t seq = 1; seq <= 300; seq += 3) {
        session_->submit(link, random_scans(1, seq, 3), 10);
        run();
        ASSERT_EQ(session_->snapshot()->robots.at(0).last_seq, seq + 2) << "what is acknowledged is there";
    }
    auto seen = one.seen();
    seen.merge(other.seen());
    mapping::Projection projection(config_);
    for (const auto& entry : logged()) {
        ASSERT_TRUE(projection.fold(entry));
        const auto at = seen.find(projection.revision());
        if (at == seen.end()) continue;
        EXPECT_EQ(testing_support::digests_of(projection.snapshot()), at->second) << at->first;
    }
}

} // namespace
} // namespace scanloom::session
