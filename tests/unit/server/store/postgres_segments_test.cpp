#include "server/store/postgres_segments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace scanloom::store::postgres {
namespace {

using testing::SizeIs;

struct Entries {
    std::vector<std::string> list;
    Revision first = 0;
};

/// Returns the entries after a revision; an error if the segment is damaged.
Result<Entries> read(SessionId session, const Segment& segment, Revision after) {
    Entries entries;
    const auto visited = visit_entries(session, segment.first, segment.last, segment.body, after,
                                       [&](Revision revision, std::string_view entry) -> Result<> {
                                           if (entries.list.empty()) entries.first = revision;
                                           entries.list.emplace_back(entry);
                                           return {};
                                       });
    if (!visited) return visited.error();
    return entries;
}

TEST(PostgresSegments, HaveAllEntriesInTheirOrderAndFewBytes) {
    std::mt19937 random(1);
    for (int round = 0; round < 200; ++round) {
        std::vector<std::string> entries(1 + random() % 50);
        for (auto& entry : entries)
            entry.assign(random() % (round % 4 == 0 ? 20'000 : 1500), static_cast<char>(random()));
        const Revision first = 1 + random() % 1000;
        std::vector<std::string> found;
        Revision next = first;
        for (const Segment& segment : segments_of(7, first, entries)) {
            ASSERT_EQ(segment.first, next);
            const auto read_back = read(7, segment, 0).value();
            ASSERT_THAT(read_back.list, SizeIs(segment.last - segment.first + 1));
            ASSERT_TRUE(read_back.list.size() == 1 || segment.body.size() <= kSegmentBytes + 4);
            found.insert(found.end(), read_back.list.begin(), read_back.list.end());
            next = segment.last + 1;
        }
        ASSERT_EQ(found, entries);
    }
}

TEST(PostgresSegments, AreReadFromAnyRevision) {
    const std::vector<std::string> entries{"a", "", "ccc"};
    const auto segments = segments_of(1, 10, entries);
    ASSERT_THAT(segments, SizeIs(1));
    const auto after = read(1, segments[0], 10).value();
    EXPECT_EQ(after.first, 11U);
    EXPECT_EQ(after.list, (std::vector<std::string>{"", "ccc"}));
    EXPECT_THAT(read(1, segments[0], 12).value().list, SizeIs(0));
}

TEST(PostgresSegments, AChangedByteOrAnotherPlaceIsDamage) {
    const std::vector<std::string> entries{"first", "second"};
    const Segment intact = segments_of(3, 5, entries).front();
    for (std::size_t at = 0; at < intact.body.size(); ++at) {
        Segment changed = intact;
        changed.body[at] = static_cast<char>(changed.body[at] ^ 1);
        EXPECT_EQ(read(3, changed, 0).error().code, Errc::kDataLoss) << at;
        changed.body.resize(at);
        EXPECT_EQ(read(3, changed, 0).error().code, Errc::kDataLoss) << at;
    }
    EXPECT_EQ(read(4, intact, 0).error().code, Errc::kDataLoss) << "of another session";
    EXPECT_EQ(read(3, {5, 7, intact.body}, 0).error().code, Errc::kDataLoss) << "an entry is missing";
    EXPECT_EQ(read(3, {5, 5, intact.body}, 0).error().code, Errc::kDataLoss) << "an entry too many";
    EXPECT_EQ(read(3, {6, 7, intact.body}, 0).error().code, Errc::kDataLoss) << "of other revisions";
}

TEST(PostgresSegments, PartsOfACheckpointHaveAChecksum) {
    const std::string sealed = sealed_part(1, "key", "value");
    EXPECT_EQ(unsealed_part(1, "key", sealed).value(), "value");
    EXPECT_EQ(unsealed_part(1, "kez", sealed).error().code, Errc::kDataLoss);
    EXPECT_EQ(unsealed_part(2, "key", sealed).error().code, Errc::kDataLoss);
    EXPECT_EQ(unsealed_part(1, "key", "").error().code, Errc::kDataLoss);
}

} // namespace
} // namespace scanloom::store::postgres
