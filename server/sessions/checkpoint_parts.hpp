#pragma once

#include "core/mapping/projection.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

/// The parts of a checkpoint: their values, their compression, and the part with the exclusions.
namespace scanloom::sessions {

// Keys and version

inline constexpr std::string_view kLaserChunk = "weave/laser/"; ///< prefix of the keys of chunks
inline constexpr std::string_view kSonarChunk = "weave/sonar/";

// Version 1 had no version number and stored chunks as in memory. Version 2 lacked the number of pages and the poses of
// the robots, so a session had to be loaded to be listed. Versions 2 and 3 stored trajectories as
// track/<index>/<block>.
inline constexpr std::uint32_t kPartsVersion = 4;

inline constexpr std::uint8_t kLocalizeOnly = 1; ///< last byte of the head in localize-only mode

// Plain values

static_assert(std::endian::native == std::endian::little, "checkpoints are written in the machine's own order");

/// Appends the bytes of a value, in the order of this machine.
/// @param out    the part
/// @param value  has no pointers, and no bytes between its members
template <class Value>
void put(std::string& out, const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Reads values from the front of a part. After the first value that does not fit, failed() stays true.
class PartReader {
public:
    /// @param bytes  must outlive this object
    explicit PartReader(std::string_view bytes) : rest_(bytes) {}

    /// Removes the next value.
    /// @return the value; a zero value if too few bytes are left, and then failed() is true
    template <class Value>
    Value take() {
        static_assert(std::is_trivially_copyable_v<Value>);
        Value value{};
        if (rest_.size() < sizeof value) {
            failed_ = true;
            return value;
        }
        std::memcpy(&value, rest_.data(), sizeof value);
        rest_.remove_prefix(sizeof value);
        return value;
    }

    /// Removes `bytes` bytes, or all that are left.
    void skip(std::size_t bytes) { rest_.remove_prefix(std::min(bytes, rest_.size())); }

    /// Returns the bytes that were not read yet.
    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

    /// Returns whether all bytes were read and no value was missing.
    [[nodiscard]] bool complete() const noexcept { return !failed_ && rest_.empty(); }

    /// Returns whether a value was missing.
    [[nodiscard]] bool failed() const noexcept { return failed_; }

private:
    std::string_view rest_;
    bool failed_ = false;
};

// Compression of chunks. The store itself does not compress, because most of its data are scans, whose ranges are
// packed already.

/// Compresses parts by Zstandard at its fastest level. Keeps tables of a few hundred KiB between parts.
/// Throws std::bad_alloc if memory ran out.
/// Threads: one at a time.
class PartCompressor {
public:
    PartCompressor();

    /// Returns one Zstandard frame that states the number of bytes.
    [[nodiscard]] std::string compressed(std::string_view bytes);

private:
    struct Free {
        void operator()(ZSTD_CCtx_s* context) const noexcept;
    };
    std::unique_ptr<ZSTD_CCtx_s, Free> context_;
};

/// Decompresses parts.
/// Throws std::bad_alloc if memory ran out.
/// Threads: one at a time.
class PartDecompressor {
public:
    PartDecompressor();

    /// Decompresses one part. Never allocates more than `bytes_max`.
    /// @param bytes      a result of PartCompressor::compressed(), maybe damaged
    /// @param bytes_max  the most bytes that the part may have
    /// @return the original bytes; nullopt if they are damaged or more than `bytes_max`
    [[nodiscard]] std::optional<std::string> decompressed(std::string_view bytes, std::size_t bytes_max);

private:
    struct Free {
        void operator()(ZSTD_DCtx_s* context) const noexcept;
    };
    std::unique_ptr<ZSTD_DCtx_s, Free> context_;
};

// Exclusions

inline constexpr std::string_view kExclusionsPart = "head/exclusions"; ///< key of the part

/// A session's exclusions, and what they left out so far.
struct ExclusionsPart {
    Exclusions exclusions;
    std::vector<std::uint64_t> excluded; ///< scans, by RobotIndex
};

/// Returns the part: the number of exclusions, the exclusions by rising id, then the number of excluded scans of each
/// robot.
[[nodiscard]] std::string exclusions_part(const mapping::ProjectionState& state);

/// Decodes a part of exclusions_part().
/// @return nullopt if the part is damaged
[[nodiscard]] std::optional<ExclusionsPart> read_exclusions_part(std::string_view value);

} // namespace scanloom::sessions
