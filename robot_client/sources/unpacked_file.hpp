#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
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

/// Reads the bytes of a file, plain or decompressed from gzip or bzip2. Zero bytes after compressed data are padding,
/// as archives and tapes leave it.
///
/// Threads: one at a time.
class UnpackedFile {
public:
    /// Opens the file. is_open() returns whether that succeeded; errno holds the reason if not.
    explicit UnpackedFile(const std::filesystem::path& path);

    [[nodiscard]] bool is_open() const { return file_.is_open(); }
    [[nodiscard]] Packing packing() const noexcept { return packing_; }

    /// Fills `text`, which must not be empty, from its beginning. Bytes before damage are returned first.
    /// @return number of bytes, 0 at the end; nullopt if the compressed data are damaged or truncated
    [[nodiscard]] std::optional<std::size_t> read(std::span<char> text);

    /// Returns how many bytes of the file itself were read, compressed or not.
    [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_; }

    /// Returns whether the end was reached because reading the file failed.
    [[nodiscard]] bool has_failed() const { return file_.bad(); }

private:
    void refill();
    [[nodiscard]] std::size_t read_plain(std::span<char> text);
    [[nodiscard]] bool only_zeros_are_left();

    std::ifstream file_;
    std::array<char, 16384> buffer_{};
    std::string_view packed_; ///< the remaining part of the buffer
    Packing packing_ = Packing::kPlain;
    std::unique_ptr<MemberUnpacker> member_; ///< empty between two members
    std::uint64_t bytes_read_ = 0;
    bool is_first_member_ = true;
    bool is_damaged_ = false;
};

} // namespace scanloom::robot
