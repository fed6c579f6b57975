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

/// What may happen to one direction of a link.
enum class Harm {
    kNone,
    kSplit,     ///< every byte travels alone
    kDelay,     ///< every piece comes a little later
    kStall,     ///< at some byte nothing comes for a while
    kHalfOpen,  ///< from some byte on nothing comes, and nobody is told
    kReset,     ///< at some byte the connection is reset
    kTruncate,  ///< at some byte it is closed in good order
    kFlip,      ///< a bit of some frame is flipped
    kDuplicate, ///< some frame comes twice
    kReorder,   ///< some frame comes after the one behind it
};
inline constexpr int kHarms = 10;

[[nodiscard]] std::string_view name_of(Harm harm);

/// Bytes to be sent on, after a pause.
struct Piece {
    std::string bytes;
    std::chrono::microseconds pause{0};
};

/// How a link ends.
enum class Ending { kNone, kReset, kClosed };

/// One direction of a link, spoiled. All comes from the seed; no socket, no clock.
///
/// Usage   whatever came: take(); send the pieces on, one after the other; then look at ending().
class SpoiledStream {
public:
    /// `forges`: a flipped bit gets a checksum that fits, so that nobody can see it. For trying what tries others.
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
    std::uint64_t at_byte_;  // where it happens, of those that harm bytes
    std::uint64_t at_frame_; // likewise, of those that harm frames
    std::uint64_t bytes_ = 0;
    std::uint64_t frames_ = 0;
    std::string frame_;                 // what there is of the next one
    std::optional<std::string> behind_; // a frame that the next one overtakes
    Ending ending_ = Ending::kNone;
};

} // namespace scanloom::fault
