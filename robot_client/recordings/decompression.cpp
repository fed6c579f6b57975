#include "robot_client/recordings/decompression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <new>

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>
#include <zstd_errors.h>

namespace scanloom::robot {
namespace {

enum class StreamState { kGoesOn, kEnded, kDamaged, kWrongChecksum };

/// What one call of a library consumed and produced.
struct StreamStep {
    std::size_t taken = 0;
    std::size_t made = 0;
    StreamState state = StreamState::kGoesOn;
};

class Bzip2Stream {
public:
    static constexpr std::string_view kName = "bz2";
    static constexpr std::string_view kMagic = "BZh";
    static constexpr std::size_t kPieceBytes = std::numeric_limits<unsigned>::max();

    Bzip2Stream() {
        if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
    }
    Bzip2Stream(const Bzip2Stream&) = delete;
    Bzip2Stream& operator=(const Bzip2Stream&) = delete;
    ~Bzip2Stream() { BZ2_bzDecompressEnd(&stream_); }

    StreamStep step(std::string_view packed, char* to, std::size_t room) {
        const auto given = static_cast<unsigned>(packed.size());
        const auto wanted = static_cast<unsigned>(std::min(room, kPieceBytes));
        stream_.next_in = const_cast<char*>(packed.data()); // only read
        stream_.avail_in = given;
        stream_.next_out = to;
        stream_.avail_out = wanted;
        const int result = BZ2_bzDecompress(&stream_);
        if (result == BZ_MEM_ERROR) throw std::bad_alloc();
        const auto state = result == BZ_STREAM_END ? StreamState::kEnded
                           : result == BZ_OK       ? StreamState::kGoesOn
                                                   : StreamState::kDamaged;
        return {given - stream_.avail_in, wanted - stream_.avail_out, state};
    }

private:
    bz_stream stream_{};
};

// LZ4 and zstd report nothing of what they made in a call that ends with an error. Small pieces make that little.
constexpr std::size_t kSmallPieceBytes = 4096;

class Lz4Stream {
public:
    static constexpr std::string_view kName = "lz4";
    static constexpr std::string_view kMagic = "\x04\x22\x4d\x18";
    static constexpr std::size_t kPieceBytes = kSmallPieceBytes;

    Lz4Stream() {
        if (LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)) != 0) throw std::bad_alloc();
    }
    Lz4Stream(const Lz4Stream&) = delete;
    Lz4Stream& operator=(const Lz4Stream&) = delete;
    ~Lz4Stream() { LZ4F_freeDecompressionContext(context_); }

    StreamStep step(std::string_view packed, char* to, std::size_t room) {
        std::size_t taken = packed.size();
        std::size_t made = room;
        const std::size_t result = LZ4F_decompress(context_, to, &made, packed.data(), &taken, nullptr);
        if (LZ4F_isError(result) != 0) {
            const std::string_view error = LZ4F_getErrorName(result);
            const bool is_checksum = error == "ERROR_contentChecksum_invalid";
            return {0, 0, is_checksum ? StreamState::kWrongChecksum : StreamState::kDamaged};
        }
        return {taken, made, result == 0 ? StreamState::kEnded : StreamState::kGoesOn};
    }

private:
    LZ4F_dctx* context_ = nullptr;
};

class ZstdStream {
public:
    static constexpr std::string_view kName = "zstd";
    static constexpr std::string_view kMagic = kZstdMagic;
    static constexpr std::size_t kPieceBytes = kSmallPieceBytes;

    ZstdStream() : context_(ZSTD_createDCtx()) {
        if (!context_) throw std::bad_alloc();
    }

    StreamStep step(std::string_view packed, char* to, std::size_t room) {
        ZSTD_inBuffer in{packed.data(), packed.size(), 0};
        ZSTD_outBuffer out{to, room, 0};
        const std::size_t result = ZSTD_decompressStream(context_.get(), &out, &in);
        if (ZSTD_isError(result) != 0) {
            const bool is_checksum = ZSTD_getErrorCode(result) == ZSTD_error_checksum_wrong;
            return {0, 0, is_checksum ? StreamState::kWrongChecksum : StreamState::kDamaged};
        }
        return {in.pos, out.pos, result == 0 ? StreamState::kEnded : StreamState::kGoesOn};
    }

private:
    struct Free {
        void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
    };
    std::unique_ptr<ZSTD_DCtx, Free> context_;
};

template <class Stream>
std::optional<std::string> run_streams(std::string_view& packed, std::size_t size_max, std::string& bytes) {
    constexpr std::size_t kFirstRoom = 65'536;
    std::optional<Stream> stream(std::in_place);
    std::size_t made = 0;
    const auto end = [&](std::size_t size, std::optional<std::string> reason) {
        bytes.resize(size);
        return reason;
    };
    for (;;) {
        // One byte more than is wanted shows whether there is more.
        if (made == bytes.size()) bytes.resize(std::min(size_max + 1, std::max(kFirstRoom, 2 * made)));
        const auto piece = packed.substr(0, Stream::kPieceBytes);
        const StreamStep step = stream->step(piece, bytes.data() + made, bytes.size() - made);
        packed.remove_prefix(step.taken);
        made += step.made;
        if (step.state == StreamState::kWrongChecksum) {
            return end(0, fmt::format("the checksum of the {} data is wrong", Stream::kName));
        }
        if (made > size_max) {
            return end(size_max, fmt::format("the {} data is larger than {} bytes", Stream::kName, size_max));
        }
        if (step.state == StreamState::kDamaged) return end(made, fmt::format("the {} data is damaged", Stream::kName));
        if (step.state == StreamState::kEnded) {
            if (!packed.starts_with(Stream::kMagic)) return end(made, std::nullopt);
            stream.emplace(); // another stream follows
        } else if (step.taken == 0 && step.made == 0) {
            return end(made, fmt::format("the {} data is truncated", Stream::kName));
        }
    }
}

/// Returns how many bytes are of intact blocks. bzip2 emits a block before it checks the block's checksum, but takes no
/// input for the next block before the check.
std::size_t intact_bzip2_bytes(std::string_view packed, std::size_t size_max) {
    Bzip2Stream stream;
    std::array<char, 4096> room{};
    std::size_t made = 0;
    std::size_t intact = 0;
    for (;;) {
        const StreamStep step = stream.step(packed.substr(0, 1), room.data(), room.size());
        if (step.taken > 0) intact = made;
        made += step.made;
        packed.remove_prefix(step.taken);
        if (step.state == StreamState::kDamaged) return intact;
        if (made > size_max) return size_max;
        if (step.state == StreamState::kEnded || (step.taken == 0 && step.made == 0)) return made;
    }
}

} // namespace

std::optional<std::string> decompress(Compression compression, std::string_view packed, std::size_t size_max,
                                      std::string& bytes, std::size_t* taken) {
    bytes.clear();
    std::string_view rest = packed;
    std::optional<std::string> reason;
    switch (compression) {
    case Compression::kBzip2:
        reason = run_streams<Bzip2Stream>(rest, size_max, bytes);
        if (reason) bytes.resize(std::min(bytes.size(), intact_bzip2_bytes(packed, size_max)));
        break;
    case Compression::kLz4: reason = run_streams<Lz4Stream>(rest, size_max, bytes); break;
    case Compression::kZstd: reason = run_streams<ZstdStream>(rest, size_max, bytes); break;
    }
    if (taken != nullptr) *taken = packed.size() - rest.size();
    return reason;
}

std::optional<Compression> compression_of(std::string_view packed) {
    if (packed.starts_with(Bzip2Stream::kMagic)) return Compression::kBzip2;
    if (packed.starts_with(Lz4Stream::kMagic)) return Compression::kLz4;
    if (packed.starts_with(ZstdStream::kMagic)) return Compression::kZstd;
    return std::nullopt;
}

} // namespace scanloom::robot
