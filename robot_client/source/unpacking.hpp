#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

namespace scanloom::robot {

enum class Packing { kPlain, kGzip, kBzip2 };

/// Determines the format from the first bytes of a file.
[[nodiscard]] Packing packing_of(std::string_view first_bytes) noexcept;

/// The result of one step of decompression.
struct Unpacked {
    enum class State { kGoesOn, kEnded, kDamaged };

    std::size_t taken = 0; ///< compressed bytes consumed
    std::size_t made = 0;  ///< bytes of text produced
    State state = State::kGoesOn;
};

/// Decompresses one member of a gzip or bzip2 file. A file may contain several members in sequence.
class MemberUnpacker {
public:
    virtual ~MemberUnpacker() = default;

    /// Consumes as much of `packed` and fills as much of `text` as possible. If it does neither, it needs more input.
    /// Not called after a state other than kGoesOn.
    [[nodiscard]] virtual Unpacked step(std::string_view packed, std::span<char> text) = 0;
};

/// Pre: `packing` is not kPlain.
[[nodiscard]] std::unique_ptr<MemberUnpacker> unpacker_of(Packing packing);

} // namespace scanloom::robot
