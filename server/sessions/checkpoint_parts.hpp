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

/// Encodes and decodes plain values in the parts of a checkpoint.
namespace scanloom::session {

static_assert(std::endian::native == std::endian::little, "checkpoints are written in the machine's own order");

/// Appends the bytes of `value`.
template <class Value>
void put(std::string& out, const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Reads values from the front of a part. After the first value that does not fit, failed() stays true.
class PartReader {
public:
    explicit PartReader(std::string_view bytes) : rest_(bytes) {}

    /// Removes and returns the next value; a zero value if too few bytes are left.
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

    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

    /// Returns whether all bytes were read and no value was missing.
    [[nodiscard]] bool complete() const noexcept { return !failed_ && rest_.empty(); }
    [[nodiscard]] bool failed() const noexcept { return failed_; }

private:
    std::string_view rest_;
    bool failed_ = false;
};

} // namespace scanloom::session

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

/// Compression of a checkpoint's chunks by Zstandard at its fastest level. The store itself does not compress, because
/// most of its data are scans, whose ranges are packed already.
namespace scanloom::session {

/// Compresses parts. Keeps tables of a few hundred KiB between parts.
/// Throws std::bad_alloc if memory ran out.
/// Threads: one at a time.
class PartCompressor {
public:
    PartCompressor();

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

    /// Returns the original bytes; nullopt if they are damaged or more than `bytes_max`. Never allocates more than
    /// `bytes_max`.
    [[nodiscard]] std::optional<std::string> decompressed(std::string_view bytes, std::size_t bytes_max);

private:
    struct Free {
        void operator()(ZSTD_DCtx_s* context) const noexcept;
    };
    std::unique_ptr<ZSTD_DCtx_s, Free> context_;
};

} // namespace scanloom::session

/// The checkpoint part that holds a session's exclusions.
///
/// Format: the number of exclusions, the exclusions by rising id, then the number of excluded scans of each robot.
namespace scanloom::session {

inline constexpr std::string_view kExclusionsPart = "head/exclusions"; ///< key of the part

struct ExclusionsPart {
    Exclusions exclusions;
    std::vector<std::uint64_t> excluded; ///< scans, by RobotIndex
};

[[nodiscard]] std::string exclusions_part(const mapping::ProjectionState& state);

/// Returns nullopt if the part is damaged.
[[nodiscard]] std::optional<ExclusionsPart> read_exclusions_part(std::string_view value);

} // namespace scanloom::session
