#include "common/hash/sha256.hpp"

#include <gtest/gtest.h>

namespace scanloom {
namespace {

// Examples of NIST's "SHA-256" example computations for FIPS 180-4.
TEST(Sha256, MatchesTheStandardsExamples) {
    Sha256 hash;
    hash.update("abc");
    EXPECT_EQ(hash.hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(Sha256().hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, HashOfPiecesEqualsHashOfTheWhole) {
    Sha256 pieces;
    for (const char* piece : {"abcdbcdecdefdefgefgh", "fghighijhijk", "ijkljklmklmnlmnomnopnopq"}) pieces.update(piece);
    EXPECT_EQ(pieces.hex(), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

} // namespace
} // namespace scanloom
