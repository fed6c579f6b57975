#include "server/store/table_carving.hpp"

#include "server/store/record.hpp"
#include "tests/support/table_block.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace scanloom::store {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// What is found, as "session/revision", or "session" of a record.
std::vector<std::string> carved(std::string_view table) {
    std::vector<std::string> found;
    carve_table(table, [&](std::string_view key, std::string_view sealed_value) {
        EXPECT_TRUE(unsealed(key, sealed_value));
        auto name = std::to_string(*owner_of(key));
        if (const auto revision = revision_of(key)) name += "/" + std::to_string(*revision);
        found.push_back(std::move(name));
    });
    return found;
}

TEST(TableCarving, FindsRecordsAndEntriesAndNothingElse) {
    TableBlock block;
    block.put(part_key(3, "map"), sealed(part_key(3, "map"), "a part of a checkpoint"));
    block.put("f", sealed("f", number_bytes(2)));
    block.entry(3, 1, "first").entry(3, 2, "second").entry(4, 1, "another");
    block.put("n", sealed("n", number_bytes(5)));
    block.record(3, "three").record(4, "four");
    EXPECT_THAT(carved(block.bytes()), ElementsAre("3/1", "3/2", "4/1", "3", "4"));
    EXPECT_THAT(carved(std::string(37, '\x7f') + block.bytes() + block.bytes()), SizeIs(10)) << "wherever they lie";
    EXPECT_THAT(carved(""), IsEmpty());
}

TEST(TableCarving, AnEntryThatIsDamagedCostsNoOther) {
    for (std::size_t byte = 0;; ++byte) {
        TableBlock block;
        block.entry(7, 8, "before");
        const auto begin = block.bytes().size();
        block.entry(7, 9, "this one is hit somewhere");
        const auto end = block.bytes().size();
        block.entry(7, 10, "behind").entry(7, 11, "and behind it").record(7, "seven");
        if (begin + byte == end) break;
        auto bytes = block.bytes();
        bytes[begin + byte] = static_cast<char>(bytes[begin + byte] ^ 0x10);
        auto found = carved(bytes);
        std::erase(found, "7/9"); // of which a number that is not needed may have been hit
        EXPECT_THAT(found, ElementsAre("7/8", "7/10", "7/11", "7")) << "byte " << byte;
    }
}

TEST(TableCarving, KeysAreToldFromTheOneBeforeAlsoWhereThatIsDamagedAndItsLastDigitsHadRunOver) {
    TableBlock block;
    block.entry(1, 255, "last intact");
    block.entry(1, 256, "damaged");
    const auto hit = block.bytes().size() - 1;
    block.entry(1, 257, "says only its last byte");
    auto bytes = block.bytes();
    bytes[hit] = static_cast<char>(bytes[hit] ^ 1);
    EXPECT_THAT(carved(bytes), ElementsAre("1/255", "1/257"));
}

TEST(TableCarving, WhereTheFirstOfASessionOrOfItsKindIsDamagedTheNextAreFound) {
    const auto damaged_at_end_of = [](TableBlock block, auto... behind) {
        const auto hit = block.bytes().size() - 1;
        (behind(block), ...);
        auto bytes = block.bytes();
        bytes[hit] = static_cast<char>(bytes[hit] ^ 1);
        return carved(bytes);
    };
    const auto two_more = [](TableBlock& block) { block.entry(9, 2, "the second").entry(9, 3, "the third"); };
    EXPECT_THAT(damaged_at_end_of(TableBlock().entry(9, 1, "the first of all"), two_more), ElementsAre("9/2", "9/3"));
    EXPECT_THAT(damaged_at_end_of(TableBlock().entry(3, 700, "another's").entry(9, 1, "the first"), two_more),
                ElementsAre("3/700", "9/2", "9/3"));
    const auto records = [](TableBlock& block) { block.record(2, "two").record(3, "three"); };
    EXPECT_THAT(damaged_at_end_of(TableBlock().entry(3, 7, "an entry").record(1, "one"), records),
                ElementsAre("3/7", "2", "3"));
}

/// Whatever of its bytes is hit, also where the keys behind it say only in what they differ from its own.
TEST(TableCarving, TheFirstOfASessionCostsNoOtherWhereverItIsHit) {
    struct Place {
        const char* what;
        std::function<void(TableBlock&)> before;
        std::vector<std::pair<SessionId, Revision>> behind; // the first of them is hit
    };
    const std::vector<Place> places{
        {"of a table", [](TableBlock&) {}, {{9, 1}, {9, 2}, {9, 3}}},
        {"of a session far on", [](TableBlock& block) { block.entry(3, 70'000, "another's"); }, {{9, 1}, {9, 2}}},
        {"of the next session, and the last there is",
         [](TableBlock& block) { block.entry(3, 70'000, "another's"); },
         {{4, 1}, {4, 2}}},
        {"in another row of 256", [](TableBlock& block) { block.entry(3, 511, "before"); }, {{3, 512}, {3, 513}}},
        {"behind lost rows", [](TableBlock& block) { block.entry(3, 5, "before"); }, {{3, 900}, {3, 901}, {3, 1024}}},
    };
    for (const auto& place : places) {
        TableBlock block;
        place.before(block);
        const auto before = carved(block.bytes());
        const auto begin = block.bytes().size();
        std::size_t end = 0;
        auto expected = before;
        for (const auto& [session, revision] : place.behind) {
            block.entry(session, revision, "entry " + std::to_string(revision));
            if (end > 0) expected.push_back(std::to_string(session) + "/" + std::to_string(revision));
            if (end == 0) end = block.bytes().size();
        }
        const auto [session, last] = place.behind.back();
        block.restart().entry(session, last + 1, "with its whole key");
        expected.push_back(std::to_string(session) + "/" + std::to_string(last + 1));
        for (std::size_t byte = begin; byte < end; ++byte) {
            auto bytes = block.bytes();
            bytes[byte] = static_cast<char>(bytes[byte] ^ 0x21);
            const auto found = carved(bytes);
            EXPECT_THAT(found, testing::IsSupersetOf(expected)) << place.what << ", byte " << byte - begin;
        }
    }
}

TEST(TableCarving, TheFirstRecordCostsNoOtherWhereverItIsHit) {
    TableBlock block;
    block.entry(3, 7, "an entry");
    const auto begin = block.bytes().size();
    block.record(1, "one");
    const auto end = block.bytes().size();
    block.record(2, "two").record(3, "three");
    for (std::size_t byte = begin; byte < end; ++byte) {
        auto bytes = block.bytes();
        bytes[byte] = static_cast<char>(bytes[byte] ^ 0x21);
        EXPECT_THAT(carved(bytes), testing::IsSupersetOf({"3/7", "2", "3"})) << byte - begin;
    }
}

TEST(TableCarving, NoiseBehindAnIntactEntryTakesNoTime) {
    std::mt19937 random(4);
    TableBlock block;
    block.entry(1, 1, "an entry");
    auto noise = block.bytes();
    for (int n = 0; n < 4'000'000; ++n) noise += static_cast<char>(random());
    EXPECT_THAT(carved(noise), ElementsAre("1/1"));
}

TEST(TableCarving, KeysAreToldFromThatOfARemoval) {
    TableBlock block;
    block.record(1, "one").remove(session_key(2)).record(3, "three");
    EXPECT_THAT(carved(block.bytes()), ElementsAre("1", "3"));
    TableBlock removal_first;
    removal_first.entry(9, 1, "an entry").remove(session_key(2)).record(3, "three");
    EXPECT_THAT(carved(removal_first.bytes()), ElementsAre("9/1", "3"));
}

TEST(TableCarving, RemovedSessionsAreTold) {
    TableBlock block;
    block.put(part_key(3, "map"), sealed(part_key(3, "map"), "a part of a checkpoint"));
    block.put("f", sealed("f", number_bytes(2)));
    block.entry(3, 1, "first").remove(entry_key(3, 2)).entry(4, 1, "another");
    block.put("n", sealed("n", number_bytes(5)));
    block.record(3, "three")
        .remove(session_key(4))
        .remove(session_key(299))
        .remove(session_key(300))
        .record(301, "last");
    const std::string other_blocks(37, '\x7f');
    EXPECT_THAT(sessions_removed_in(other_blocks + block.bytes() + other_blocks), ElementsAre(4, 299, 300));
    EXPECT_THAT(sessions_removed_in(other_blocks), IsEmpty());
}

TEST(TableCarving, NothingIsFoundInNoise) {
    std::mt19937 random(1);
    std::string noise(200'000, '\0');
    for (auto& byte : noise) byte = static_cast<char>(random() % 4 == 0 ? random() % 32 : random());
    EXPECT_THAT(carved(noise), IsEmpty());
}

} // namespace
} // namespace scanloom::store
