#include "server/store/copy.hpp"

#include "common/wire/log_codec.hpp"
#include "server/store/open_store.hpp"
#include "server/store/postgres_scan_log.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/store/postgres_database.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::store {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// What a session has.
struct Content {
    std::string record;
    std::vector<std::string> entries;
    std::map<std::string, std::string> checkpoint;

    friend bool operator==(const Content&, const Content&) = default;
};

std::vector<Content> contents_of(ScanLog& log) {
    std::vector<Content> all;
    for (const auto& stored : log.sessions().value()) {
        all.push_back(
            {stored.record.value(), entries_after(log, stored.id, 0).value(), checkpoint_of(log, stored.id).value()});
    }
    return all;
}

/// Creates four sessions: two with entries and checkpoints, one that is removed again, and one without entries.
void fill(ScanLog& log) {
    for (const char* record : {"a", "removed", "b", "empty"}) {
        const auto session = log.create_session(record).value();
        if (std::string_view(record) == "empty") continue;
        for (Revision first = 1; first < 2000; first += 500) { // more than is appended at once
            ASSERT_TRUE(append_and_wait(log, session, first, distinct_entries(session, first, 500)));
        }
        ASSERT_TRUE(log.write_checkpoint(
            session, {{"", "x"}, {"large", std::string(9 << 20, 'l')}, {"larger", std::string(9 << 20, 'm')}}));
    }
    ASSERT_TRUE(log.remove_session(2));
}

TEST(CopyLog, AStoreCopiedThroughEachKindIsTheSame) {
    MemoryScanLog original;
    fill(original);
    const auto expected = contents_of(original);
    ASSERT_THAT(expected, SizeIs(3));
    const TemporaryDirectory place;
    const PostgresDatabase database;
    const StoreOptions options{.allow_unreplicated = true};
    std::vector<std::uint64_t> counts;
    {
        auto to = NewStore::begin(place.path() / "store", options).value();
        ASSERT_TRUE(
            copy_log(original, to.log(), [&](const CopiedSession& copied) { counts.push_back(copied.entries); }));
        ASSERT_TRUE(to.finish());
    }
    EXPECT_THAT(counts, ElementsAre(2000, 2000, 0));
    {
        const auto from = open_store_read_only(place.path() / "store").value();
        EXPECT_EQ(contents_of(*from.log), expected);
        auto to = NewStore::begin(database.address, options).value();
        ASSERT_TRUE(copy_log(*from.log, to.log(), [](const CopiedSession&) {}));
        ASSERT_TRUE(to.finish());
    }
    const auto last = open_store(database.address, options).value();
    EXPECT_EQ(contents_of(*last), expected);
}

/// Numbers of sessions are others in the new store.
TEST(CopyLog, SessionsThatHaveReplacedOthersNameNoneAndPendingOnesAreLeftOut) {
    const auto record = [](const std::string& name, SessionId replaces) {
        wire::SessionRecord made{.name = name};
        made.replaces = replaces;
        made.entries_at_creation = replaces == 0 ? 0 : 5;
        return wire::encode_session(made);
    };
    MemoryScanLog from;
    for (const auto& one : {record("gone", 0), record("x", 0), record("lab", 1), record("x", 2)}) {
        ASSERT_TRUE(from.create_session(one));
    }
    ASSERT_TRUE(from.remove_session(1));
    MemoryScanLog to;
    ASSERT_TRUE(copy_log(from, to, [](const CopiedSession&) {}));
    const auto copied = to.sessions().value();
    ASSERT_THAT(copied, SizeIs(2));
    EXPECT_EQ(copied[0].record.value(), record("x", 0));
    EXPECT_EQ(copied[1].record.value(), record("lab", 0));
}

TEST(CopyLog, OnlyEmptyStoresAreCopiedInto) {
    MemoryScanLog from;
    MemoryScanLog to;
    static_cast<void>(to.create_session("there").value());
    EXPECT_EQ(copy_log(from, to, [](const CopiedSession&) {}).error().code, Errc::kConflict);
}

TEST(CopyLog, ErrorsEndIt) {
    MemoryScanLog from;
    fill(from);
    MemoryScanLog to;
    to.fail_from_next_change({Errc::kStoreFailed, "the disk failed"});
    EXPECT_EQ(copy_log(from, to, [](const CopiedSession&) {}).error().message, "the disk failed");
}

TEST(NewStore, IsRefusedUntilItIsFinishedAndBegunAgainAfterAKill) {
    const TemporaryDirectory place;
    const PostgresDatabase database;
    const StoreOptions options{.allow_unreplicated = true};
    for (const std::filesystem::path& store : {place.path() / "store", std::filesystem::path(database.address)}) {
        {
            auto killed = NewStore::begin(store, options).value();
            static_cast<void>(killed.log().create_session("half of it").value());
            EXPECT_EQ(NewStore::begin(store, options).error().code, Errc::kConflict) << "at the same time";
        }
        EXPECT_THAT(open_store(store, options).error().message, HasSubstr("is unfinished"));
        EXPECT_THAT(open_store_read_only(store).error().message, HasSubstr("is unfinished"));
        auto again = NewStore::begin(store, options).value();
        EXPECT_THAT(again.log().sessions().value(), SizeIs(0));
        static_cast<void>(again.log().create_session("all of it").value());
        ASSERT_TRUE(again.finish());
        EXPECT_EQ(NewStore::begin(store, options).error().code, Errc::kConflict) << "there is a store";
        EXPECT_THAT(open_store(store, options).value()->sessions().value(), SizeIs(1));
    }
}

} // namespace
} // namespace scanloom::store
