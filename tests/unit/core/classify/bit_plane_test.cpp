#include "core/classify/bit_plane.hpp"
#include "core/classify/cell_class.hpp"

#include <gtest/gtest.h>

#include <random>

namespace scanloom::classify {
namespace {

TEST(BitPlane, SetsBitsExactlyForCellsWithTheValue) {
    std::mt19937 random(1);
    std::array<CellClass, 64 * 64> cells;
    for (auto& cell : cells) cell = static_cast<CellClass>(random() % 5);
    for (int value = 0; value < 5; ++value) {
        const BitPlane plane = bits_where(cells, static_cast<CellClass>(value));
        for (std::size_t cell = 0; cell < cells.size(); ++cell) {
            const bool set = (plane[cell / 64] >> (cell % 64) & 1) != 0;
            ASSERT_EQ(set, cells[cell] == static_cast<CellClass>(value)) << "cell " << cell << ", value " << value;
        }
    }
}

TEST(BitPlane, UnpackIsTheInverseOfPack) {
    for (std::uint64_t byte = 0; byte < 256; ++byte) {
        const std::uint64_t bytes = bits::unpack8(byte);
        EXPECT_EQ(bits::pack8(bytes), byte);
        for (int bit = 0; bit < 8; ++bit) EXPECT_EQ(bytes >> (8 * bit) & 0xff, byte >> bit & 1);
    }
}

} // namespace
} // namespace scanloom::classify
