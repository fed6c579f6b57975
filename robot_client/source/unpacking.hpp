#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

namespace scanloom::robot {

enum class Packing { kPlain, kGzip, kBzip2 };

/// By the first bytes of a file, not by its name.
[[nodiscard]] Packing packing_of(std::string_view first_bytes) noexcept;

/// What one step of unpacking came to.
struct Unpacked {
    enum class State { kGoesOn, kEnded, kDamaged };

    std::size_t taken = 0; ///< packed bytes
    std::size_t made = 0;  ///< bytes of the text
    State state = State::kGoesOn;
};

/// Unpacks one member of a gzip or bzip2 file; files may hold several, one behind the other.
class MemberUnpacker {
public:
    virtual ~MemberUnpacker() = default;

    /// Takes from `packed` what it can and fills `text` as far as it can. Where it neither takes nor makes anything,
    /// it needs more. Not to be called after another state than kGoesOn.
    [[nodiscard]] virtual Unpacked step(std::string_view packed, std::span<char> text) = 0;
};

/// Pre  `packing` is not kPlain.
[[nodiscard]] std::unique_ptr<MemberUnpacker> unpacker_of(Packing packing);

} // namespace scanloom::robot
