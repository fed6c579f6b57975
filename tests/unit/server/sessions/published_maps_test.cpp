#include "server/sessions/published_maps.hpp"

#include "tests/unit/server/sessions/session_fixture.hpp"

#include <atomic>
#include <future>
#include <map>
#include <thread>

/// Maps that are written while others read them.
namespace scanloom::sessions {
namespace {

std::shared_ptr<const mapping::Snapshot> maps_at(Revision revision) {
    return std::make_shared<const mapping::Snapshot>(mapping::Snapshot{.revision = revision});
}

TEST(PublishedMaps, HeldMapsAreNotTakenBack) {
    PublishedMaps published;
    published.set(maps_at(1));
    {
        const auto held = published.get();
        EXPECT_FALSE(published.withdraw());
        EXPECT_EQ(published.get(), held);
    }
    EXPECT_TRUE(published.withdraw());
}

TEST(PublishedMaps, ReaderWaitsForTheNextMapsAfterTakeBack) {
    PublishedMaps published;
    for (Revision revision = 1; revision <= 500; ++revision) {
        published.set(maps_at(revision));
        ASSERT_TRUE(published.withdraw());
        Revision seen = 0;
        std::thread reader([&] { seen = published.get()->revision; });
        published.set(maps_at(revision + 1));
        reader.join();
        ASSERT_EQ(seen, revision + 1);
    }
}

TEST(PublishedMaps, AwaitedMapsAreNotTakenBackBeforeDelivery) {
    PublishedMaps published;
    published.set(maps_at(1));
    for (Revision revision = 2; revision <= 200; ++revision) {
        ASSERT_TRUE(published.withdraw());
        std::promise<void> release;
        Revision seen = 0;
        std::thread reader([&] {
            const auto maps = published.get();
            seen = maps->revision;
            release.get_future().wait();
        });
        while (!published.is_waited_for()) std::this_thread::yield();
        published.set(maps_at(revision));
        EXPECT_FALSE(published.withdraw()) << "a reader waits for the maps or holds them";
        release.set_value();
        reader.join();
        ASSERT_EQ(seen, revision);
    }
}

TEST(PublishedMaps, TryGetReturnsNullAfterTakeBack) {
    PublishedMaps published;
    published.set(maps_at(1));
    EXPECT_EQ(published.try_get()->revision, 1U);
    ASSERT_TRUE(published.withdraw());
    EXPECT_EQ(published.try_get(), nullptr);
    published.set(maps_at(2));
    EXPECT_EQ(published.try_get()->revision, 2U);
}

TEST(PublishedMaps, FallBackReplacesOnlyMapsTakenBack) {
    PublishedMaps published;
    published.set(maps_at(1));
    published.fall_back_to(maps_at(7));
    EXPECT_EQ(published.get()->revision, 1U);
    ASSERT_TRUE(published.withdraw());
    published.fall_back_to(maps_at(7));
    EXPECT_EQ(published.get()->revision, 7U);
}

const mapping::LaserChunk* chunk_at_origin(const mapping::Snapshot& maps) { return maps.laser.find({0, 0}); }

TEST_F(SessionTest, ScansAreIntegratedInPlaceWithoutASnapshot) {
    const auto link = join("r");
    auto scans = random_scans(1, 1, 3);
    for (auto& scan : scans) scan.pose = Pose2{};
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
    EXPECT_NE(chunk_at_origin(*session_->snapshot()), chunk) << "a snapshot is held";
    EXPECT_EQ(testing_support::digests_of(*held), before);
    EXPECT_EQ(digest(), digest_of_log());
}

/// Takes snapshots repeatedly and records their digests by revision.
class SnapshotReader {
public:
    explicit SnapshotReader(std::shared_ptr<Session> session) : thread_([this, session] { read(*session); }) {}

    [[nodiscard]] std::map<Revision, std::string> seen() {
        done_ = true;
        thread_.join();
        return std::move(seen_);
    }

private:
    void read(const Session& session) {
        for (Revision newest = 0; !done_;) {
            const auto maps = session.snapshot();
            EXPECT_GE(maps->revision, newest) << "revisions increase";
            newest = maps->revision;
            if (seen_.size() < 40) seen_.try_emplace(newest, testing_support::digests_of(*maps));
        }
    }

    std::map<Revision, std::string> seen_;
    std::atomic<bool> done_ = false;
    std::thread thread_;
};

TEST_F(SessionTest, ConcurrentReadersSeeConsistentMaps) {
    const auto link = join("r");
    SnapshotReader one(session_);
    SnapshotReader other(session_);
    for (std::uint64_t seq = 1; seq <= 300; seq += 3) {
        session_->submit(link, random_scans(1, seq, 3), 10);
        run();
        ASSERT_EQ(session_->snapshot()->robots.at(0).last_seq, seq + 2) << "acknowledged scans are in the map";
    }
    auto seen = one.seen();
    seen.merge(other.seen());
    mapping::Projection projection(config_);
    for (const auto& entry : logged()) {
        ASSERT_TRUE(projection.apply(entry));
        const auto at = seen.find(projection.revision());
        if (at == seen.end()) continue;
        EXPECT_EQ(testing_support::digests_of(projection.snapshot()), at->second) << at->first;
    }
}

} // namespace
} // namespace scanloom::sessions
