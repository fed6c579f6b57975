#include "common/wire/packed_ranges.hpp"

#include "common/scan/limits.hpp"

#include <gtest/gtest.h>

#include <random>

namespace scanloom::wire {
namespace {

using Ranges = std::vector<RangeMm>;

TEST(PackedRanges, HaveTheDocumentedBytes) {
    EXPECT_EQ(pack_ranges({}), std::string("\0\0", 2));
    EXPECT_EQ(pack_ranges(Ranges{0, 0}), std::string("\2\0\0", 3));
    EXPECT_EQ(pack_ranges(Ranges{5, 3}), std::string("\2\0\1\x0a\3", 5));
    EXPECT_EQ(pack_ranges(Ranges{1000, kNoReturn}), std::string("\2\0\2\xd0\x07\xd1\x07", 7)); // no return: -1
    EXPECT_EQ(pack_ranges(Ranges{0x12345678}), std::string("\1\0\4\xf0\xac\x68\x24", 7));
    Ranges seventeen(17, 7);
    seventeen[16] = 6;
    EXPECT_EQ(pack_ranges(seventeen), std::string("\x11\0\1\x0e", 4) + std::string(15, '\0') + "\1\1");
}

TEST(PackedRanges, UnpackingReturnsTheOriginal) {
    std::mt19937 random(7);
    for (std::size_t beams = 0; beams < 600; ++beams) {
        Ranges ranges(beams);
        RangeMm range = 3000;
        for (auto& one : ranges) {
            range += static_cast<RangeMm>(random() % 41) - 20;
            const auto kind = random() % 40;
            one = kind == 0   ? kInvalidRange
                  : kind == 1 ? kNoReturn
                  : kind == 2 ? static_cast<RangeMm>(random())
                              : range;
        }
        const auto packed = pack_ranges(ranges);
        ASSERT_EQ(unpack_ranges(packed), ranges) << beams;
        for (std::size_t kept = 0; kept < packed.size(); kept += 1 + random() % 50) {
            ASSERT_FALSE(unpack_ranges(std::string_view(packed).substr(0, kept))) << kept << " of " << packed.size();
        }
        EXPECT_FALSE(unpack_ranges(packed + '\0'));
    }
}

TEST(PackedRanges, LaserRangesTakeAThirdOfTheirSize) {
    std::mt19937 random(8);
    Ranges ranges;
    for (std::uint32_t beam = 0; beam < 684; ++beam)
        ranges.push_back(2000 + 7 * beam % 900 + static_cast<RangeMm>(random() % 20));
    EXPECT_LT(pack_ranges(ranges).size(), 684U * 4 / 3);
}

TEST(PackedRanges, InvalidBytesAreRefused) {
    EXPECT_FALSE(unpack_ranges(std::string("\1\0\3\0\0\0", 6))) << "an invalid width";
    EXPECT_FALSE(unpack_ranges(std::string("\1\x10\0", 3) + std::string(257, '\0')))
        << "more beams than a scan may have";
    EXPECT_EQ(unpack_ranges(std::string("\0\x10", 2) + std::string(256, '\0')), Ranges(kBeamsMax));
    EXPECT_FALSE(unpack_ranges(std::string("\2\0\1\x0a\3\0", 6))) << "an extra byte after the last beam";
}

TEST(PackedRanges, WiderBlocksThanNeededAreAccepted) {
    EXPECT_EQ(unpack_ranges(std::string("\2\0\2\x0a\0\3\0", 7)), (Ranges{5, 3}));
    EXPECT_EQ(unpack_ranges(std::string("\1\0\4\0\0\0\0", 7)), Ranges{0});
}

} // namespace
} // namespace scanloom::wire
