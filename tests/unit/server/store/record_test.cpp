#include "server/store/record.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace scanloom::store {
namespace {

TEST(StoreRecord, KeysSortAsSessionsAndRevisionsDo) {
    const std::vector<std::uint64_t> numbers = {0, 1, 255, 256, 65536, 0xffffffff, 0x100000000};
    std::vector<std::string> keys;
    for (const auto session : numbers) {
        for (const auto revision : numbers) keys.push_back(entry_key(session, revision));
    }
    EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
}

TEST(StoreRecord, ASessionsRangeHasExactlyItsKeys) {
    const KeyRange entries = entries_of(7);
    const KeyRange parts = parts_of(7);
    for (const Revision revision : {Revision{0}, Revision{1}, std::numeric_limits<Revision>::max()}) {
        EXPECT_TRUE(entries.begin <= entry_key(7, revision) && entry_key(7, revision) < entries.end);
        EXPECT_FALSE(entries.begin <= entry_key(6, revision) && entry_key(6, revision) < entries.end);
        EXPECT_FALSE(entries.begin <= entry_key(8, revision) && entry_key(8, revision) < entries.end);
    }
    for (const std::string& part : {std::string(), std::string(20, '\xff')}) {
        EXPECT_TRUE(parts.begin <= part_key(7, part) && part_key(7, part) < parts.end);
        EXPECT_FALSE(parts.begin <= part_key(6, part) && part_key(6, part) < parts.end);
        EXPECT_FALSE(parts.begin <= part_key(8, part) && part_key(8, part) < parts.end);
    }
}

TEST(StoreRecord, KeysAreParsedAndOtherBytesAreRefused) {
    EXPECT_EQ(session_of(session_key(42)), 42U);
    EXPECT_EQ(revision_of(entry_key(1, 300)), 300U);
    EXPECT_EQ(part_of(part_key(1, "chunk")), "chunk");
    EXPECT_FALSE(session_of(entry_key(1, 1)));
    EXPECT_FALSE(session_of(session_key(1) + "x"));
    EXPECT_FALSE(revision_of(session_key(1)));
    EXPECT_FALSE(revision_of(part_key(1, "12345678")));
    EXPECT_FALSE(part_of("c123"));
    EXPECT_FALSE(number_of("1234567"));
}

TEST(StoreRecord, AnyFlippedBitOfKeyOrValueIsFound) {
    const std::string key = entry_key(3, 9);
    const std::string value = sealed(key, "a scan's bytes");
    ASSERT_EQ(unsealed(key, value), "a scan's bytes");
    for (std::size_t bit = 0; bit < value.size() * 8; ++bit) {
        std::string flipped = value;
        flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
        EXPECT_FALSE(unsealed(key, flipped)) << "bit " << bit;
    }
    EXPECT_FALSE(unsealed(entry_key(3, 10), value)) << "another entry's value";
    for (std::size_t size = 0; size < value.size(); ++size) EXPECT_FALSE(unsealed(key, value.substr(0, size)));
}

} // namespace
} // namespace scanloom::store
