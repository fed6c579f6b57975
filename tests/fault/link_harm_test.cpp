#include "tests/fault/link_harm.hpp"

#include "common/wire/messages.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <numeric>

namespace scanloom::fault {
namespace {

constexpr std::uint64_t kSeeds = 100;

/// Returns frames 1, 2, ... of a stream long enough for every fault.
std::vector<std::string> frames() {
    std::vector<std::string> made(40);
    for (std::size_t n = 0; n < made.size(); ++n) wire::encode(wire::Ping{n + 1}, made[n]);
    return made;
}

std::string joined(const std::vector<std::string>& frames) {
    return std::accumulate(frames.begin(), frames.end(), std::string());
}

/// Passes the stream in pieces of 7 bytes, as a socket may.
std::vector<Piece> spoiled(SpoiledStream& stream, std::string_view bytes) {
    std::vector<Piece> pieces;
    for (; !bytes.empty(); bytes.remove_prefix(std::min<std::size_t>(7, bytes.size()))) {
        for (auto& piece : stream.take(bytes.substr(0, 7))) pieces.push_back(std::move(piece));
    }
    return pieces;
}

std::string bytes_of(const std::vector<Piece>& pieces) {
    std::string bytes;
    for (const auto& piece : pieces) bytes += piece.bytes;
    return bytes;
}

TEST(SpoiledStream, SplitsDelaysAndStallsKeepAllBytes) {
    const auto sent = joined(frames());
    for (const Harm harm : {Harm::kNone, Harm::kSplit, Harm::kDelay, Harm::kStall}) {
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            SpoiledStream stream(harm, seed);
            EXPECT_EQ(bytes_of(spoiled(stream, sent)), sent) << name_of(harm) << ' ' << seed;
            EXPECT_EQ(stream.ending(), Ending::kNone);
        }
    }
    SpoiledStream stream(Harm::kSplit, 1);
    EXPECT_EQ(spoiled(stream, sent).size(), sent.size());
}

TEST(SpoiledStream, FaultsThatEndTheLinkForwardAPrefix) {
    const std::string sent(20'000, 'x');
    for (const Harm harm : {Harm::kHalfOpen, Harm::kReset, Harm::kTruncate}) {
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            SpoiledStream stream(harm, seed);
            EXPECT_LT(bytes_of(spoiled(stream, sent)).size(), sent.size());
            EXPECT_EQ(stream.ending() == Ending::kNone, harm == Harm::kHalfOpen);
        }
    }
}

TEST(SpoiledStream, FlipChangesExactlyOneBit) {
    const auto sent = joined(frames());
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        SpoiledStream stream(Harm::kFlip, seed);
        const auto received = bytes_of(spoiled(stream, sent));
        ASSERT_EQ(received.size(), sent.size());
        int flipped = 0;
        for (std::size_t n = 0; n < sent.size(); ++n) {
            flipped += std::popcount(static_cast<unsigned char>(sent[n] ^ received[n]));
        }
        EXPECT_EQ(flipped, 1) << seed;
    }
}

TEST(SpoiledStream, DuplicatesOrReordersOneFrame) {
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        auto twice = frames();
        auto late = frames();
        SpoiledStream doubling(Harm::kDuplicate, seed);
        SpoiledStream reordering(Harm::kReorder, seed);
        const auto at = [&](const std::string& received) {
            std::size_t first = 0;
            while (received.substr(0, joined({late.begin(), late.begin() + static_cast<long>(first) + 1}).size()) ==
                   joined({late.begin(), late.begin() + static_cast<long>(first) + 1})) {
                ++first;
            }
            return first;
        };
        const auto doubled = bytes_of(spoiled(doubling, joined(twice)));
        const auto reordered = bytes_of(spoiled(reordering, joined(late)));
        const auto n = at(doubled) - 1;
        twice.insert(twice.begin() + static_cast<long>(n), twice[n]);
        EXPECT_EQ(doubled, joined(twice)) << seed;
        const auto m = at(reordered);
        std::swap(late[m], late[m + 1]);
        EXPECT_EQ(reordered, joined(late)) << seed;
    }
}

} // namespace
} // namespace scanloom::fault
