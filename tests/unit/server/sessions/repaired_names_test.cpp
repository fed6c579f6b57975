#include "server/sessions/repair.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::sessions {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::optional<std::string> named(std::string name) {
    wire::SessionRecord record;
    record.name = std::move(name);
    return wire::encode_session(record);
}

TEST(RepairedNames, UniqueNamesAreKept) {
    EXPECT_THAT(repaired_names({{1, named("kitchen")}, {5, named("hall")}}),
                ElementsAre(Pair(1, "kitchen"), Pair(5, "hall")));
}

TEST(RepairedNames, SessionWithoutValidRecordIsNamedByItsId) {
    EXPECT_THAT(repaired_names({{3, std::nullopt}, {4, "\xff\xff"}}),
                ElementsAre(Pair(3, "session-3"), Pair(4, "session-4")));
}

TEST(RepairedNames, NewestOfEqualNamesKeepsItsName) {
    EXPECT_THAT(repaired_names({{2, named("kitchen")}, {5, named("kitchen")}, {9, named("kitchen")}}),
                ElementsAre(Pair(2, "kitchen-2"), Pair(5, "kitchen-5"), Pair(9, "kitchen")));
}

TEST(RepairedNames, AssignedNamesNeverReplaceExistingOnes) {
    EXPECT_THAT(repaired_names({{1, named("kitchen-2")}, {2, named("kitchen")}, {3, named("kitchen")}}),
                ElementsAre(Pair(1, "kitchen-2"), Pair(2, "kitchen-2-2"), Pair(3, "kitchen")));
    EXPECT_THAT(repaired_names(
                    {{1, named("kitchen-2")}, {2, named("kitchen")}, {3, named("kitchen")}, {4, named("kitchen-2-2")}}),
                testing::Contains(Pair(2, "kitchen-2-2-2")));
    EXPECT_THAT(repaired_names({{7, std::nullopt}, {8, named("session-7")}}),
                ElementsAre(Pair(7, "session-7-7"), Pair(8, "session-7")));
}

TEST(RepairedNames, AssignedNamesRespectTheLengthLimit) {
    const std::string longest(kNameBytesMax, 'k');
    EXPECT_THAT(repaired_names({{12, named(longest)}, {13, named(longest)}}),
                ElementsAre(Pair(12, std::string(kNameBytesMax - 3, 'k') + "-12"), Pair(13, longest)));
}

} // namespace
} // namespace scanloom::sessions
