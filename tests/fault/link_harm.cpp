#include "tests/fault/link_harm.hpp"

#include "common/wire/frame_checksum.hpp"
#include "common/wire/frame_decoder.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>
#include <utility>

namespace scanloom::fault {
namespace {

using std::chrono::microseconds;

constexpr std::uint64_t kSplitBytes = 3'000; // later bytes are sent together: single bytes are slow and reveal no more
constexpr std::uint64_t kDelayMax = 2'000;   // microseconds
constexpr std::uint64_t kStallMax = 400'000; // microseconds: longer than some timeouts
constexpr std::uint64_t kFramesReached = 12;

/// Returns small numbers as often as large ones, as most events happen at the start of a connection.
std::uint64_t some_byte(std::mt19937_64& random) { return random() % (std::uint64_t{1} << (3 + random() % 11)); }

bool harms_frames(Harm harm) { return harm == Harm::kFlip || harm == Harm::kDuplicate || harm == Harm::kReorder; }

std::size_t length_of(const std::string& frame) {
    return boost::endian::load_big_u32(reinterpret_cast<const unsigned char*>(frame.data()));
}

} // namespace

std::string_view name_of(Harm harm) {
    constexpr std::string_view kNames[] = {"none",  "split",    "delay", "stall",     "half_open",
                                           "reset", "truncate", "flip",  "duplicate", "reorder"};
    static_assert(std::size(kNames) == kHarms);
    return kNames[static_cast<std::size_t>(harm)];
}

SpoiledStream::SpoiledStream(Harm harm, std::uint64_t seed, bool forges)
    : harm_(harm), random_(seed), forges_(forges), at_byte_(some_byte(random_)), at_frame_(random_() % kFramesReached) {
}

std::vector<Piece> SpoiledStream::take(std::string_view bytes) {
    std::vector<Piece> pieces;
    if (harm_ == Harm::kNone) {
        pieces.push_back({std::string(bytes)});
    } else if (harm_ == Harm::kDelay) {
        pieces.push_back({std::string(bytes), microseconds(random_() % kDelayMax)});
    } else if (harms_frames(harm_)) {
        for (frame_ += bytes; frame_.size() >= wire::kLengthPrefixBytes;) {
            const std::size_t size = wire::kLengthPrefixBytes + length_of(frame_);
            if (frame_.size() < size) break;
            take_frame(frame_.substr(0, size), pieces);
            frame_.erase(0, size);
        }
    } else {
        for (const char byte : bytes) take_byte(byte, pieces);
    }
    return pieces;
}

void SpoiledStream::take_frame(std::string frame, std::vector<Piece>& pieces) {
    const bool is_meant = frames_++ == at_frame_;
    if (is_meant && harm_ == Harm::kReorder) {
        behind_ = std::move(frame);
        return;
    }
    if (is_meant && harm_ == Harm::kDuplicate) pieces.push_back({frame});
    if (is_meant && harm_ == Harm::kFlip) flip_a_bit(frame);
    pieces.push_back({std::move(frame)});
    if (behind_) pieces.push_back({*std::exchange(behind_, std::nullopt)});
}

void SpoiledStream::take_byte(char byte, std::vector<Piece>& pieces) {
    const std::uint64_t at = bytes_++;
    if (harm_ == Harm::kSplit) {
        if (pieces.empty() || at < kSplitBytes) pieces.emplace_back();
        pieces.back().bytes += byte;
        return;
    }
    if (at >= at_byte_ && harm_ != Harm::kStall) {
        if (harm_ == Harm::kReset) ending_ = Ending::kReset;
        if (harm_ == Harm::kTruncate) ending_ = Ending::kClosed;
        return;
    }
    if (pieces.empty()) pieces.emplace_back();
    if (at == at_byte_) pieces.push_back({{}, microseconds(random_() % kStallMax)});
    pieces.back().bytes += byte;
}

void SpoiledStream::flip_a_bit(std::string& frame) {
    const std::size_t first = forges_ ? wire::kLengthPrefixBytes : 0;
    const std::size_t end = frame.size() - (forges_ ? wire::kChecksumBytes : 0);
    const std::size_t byte = first + random_() % (end - first);
    frame[byte] = static_cast<char>(frame[byte] ^ 1 << random_() % 8);
    if (!forges_) return;
    const auto body = std::string_view(frame).substr(first, end - first);
    std::ranges::copy(wire::checksum_field(body), frame.begin() + static_cast<std::ptrdiff_t>(end));
}

} // namespace scanloom::fault
