#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {

/// The faults of one direction of a connection.
enum class Harm {
    kNone,
    kSplit,     ///< every byte is sent on its own
    kDelay,     ///< every piece arrives a little later
    kStall,     ///< after some byte nothing arrives for a while
    kHalfOpen,  ///< after some byte nothing arrives, and neither side is notified
    kReset,     ///< the connection is reset at some byte
    kTruncate,  ///< the connection is closed in order at some byte
    kFlip,      ///< a bit of one frame is flipped
    kDuplicate, ///< one frame arrives twice
    kReorder,   ///< one frame arrives after its successor
};
inline constexpr int kHarms = 10;

[[nodiscard]] std::string_view name_of(Harm harm);

/// Bytes to forward after a pause.
struct Piece {
    std::string bytes;
    std::chrono::microseconds pause{0};
};

/// How a connection ends.
enum class Ending { kNone, kReset, kClosed };

/// One direction of a spoiled connection. Uses only the seed, without sockets or a clock.
///
/// Usage   pass received bytes to take(); forward the returned pieces in order; then check ending().
class SpoiledStream {
public:
    /// @param forges  replaces the checksum after a bit flip so that it matches, which makes the fault undetectable.
    ///     For tests of the rows themselves.
    SpoiledStream(Harm harm, std::uint64_t seed, bool forges = false);

    [[nodiscard]] std::vector<Piece> take(std::string_view bytes);
    [[nodiscard]] Ending ending() const noexcept { return ending_; }

private:
    void take_frame(std::string frame, std::vector<Piece>& pieces);
    void take_byte(char byte, std::vector<Piece>& pieces);
    void flip_a_bit(std::string& frame);

    Harm harm_;
    std::mt19937_64 random_;
    bool forges_;
    std::uint64_t at_byte_;  // where the fault happens, for faults of bytes
    std::uint64_t at_frame_; // likewise, for faults of frames
    std::uint64_t bytes_ = 0;
    std::uint64_t frames_ = 0;
    std::string frame_;                 // the received part of the next frame
    std::optional<std::string> behind_; // a frame held back until after the next one
    Ending ending_ = Ending::kNone;
};

} // namespace scanloom::fault
