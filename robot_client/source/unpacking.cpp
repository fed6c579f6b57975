#include "robot_client/source/unpacking.hpp"

#define ZLIB_CONST
#include <bzlib.h>
#include <zlib.h>

#include <cassert>
#include <new>

namespace scanloom::robot {
namespace {

class GzipUnpacker final : public MemberUnpacker {
public:
    GzipUnpacker() {
        constexpr int kGzipOnly = 16;
        if (inflateInit2(&stream_, MAX_WBITS + kGzipOnly) != Z_OK) throw std::bad_alloc();
    }
    GzipUnpacker(const GzipUnpacker&) = delete;
    GzipUnpacker& operator=(const GzipUnpacker&) = delete;
    ~GzipUnpacker() override { inflateEnd(&stream_); }

    Unpacked step(std::string_view packed, std::span<char> text) override {
        stream_.next_in = reinterpret_cast<const Bytef*>(packed.data());
        stream_.avail_in = static_cast<uInt>(packed.size());
        stream_.next_out = reinterpret_cast<Bytef*>(text.data());
        stream_.avail_out = static_cast<uInt>(text.size());
        const int result = inflate(&stream_, Z_NO_FLUSH);
        if (result == Z_MEM_ERROR) throw std::bad_alloc();
        auto state = Unpacked::State::kDamaged;
        if (result == Z_OK || result == Z_BUF_ERROR) state = Unpacked::State::kGoesOn;
        if (result == Z_STREAM_END) state = Unpacked::State::kEnded;
        return {packed.size() - stream_.avail_in, text.size() - stream_.avail_out, state};
    }

private:
    z_stream stream_{};
};

class Bzip2Unpacker final : public MemberUnpacker {
public:
    Bzip2Unpacker() {
        if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
    }
    Bzip2Unpacker(const Bzip2Unpacker&) = delete;
    Bzip2Unpacker& operator=(const Bzip2Unpacker&) = delete;
    ~Bzip2Unpacker() override { BZ2_bzDecompressEnd(&stream_); }

    Unpacked step(std::string_view packed, std::span<char> text) override {
        stream_.next_in = const_cast<char*>(packed.data()); // only read
        stream_.avail_in = static_cast<unsigned>(packed.size());
        stream_.next_out = text.data();
        stream_.avail_out = static_cast<unsigned>(text.size());
        const int result = BZ2_bzDecompress(&stream_);
        if (result == BZ_MEM_ERROR) throw std::bad_alloc();
        auto state = Unpacked::State::kDamaged;
        if (result == BZ_OK) state = Unpacked::State::kGoesOn;
        if (result == BZ_STREAM_END) state = Unpacked::State::kEnded;
        return {packed.size() - stream_.avail_in, text.size() - stream_.avail_out, state};
    }

private:
    bz_stream stream_{};
};

} // namespace

Packing packing_of(std::string_view first_bytes) noexcept {
    if (first_bytes.starts_with("\x1f\x8b")) return Packing::kGzip;
    if (first_bytes.starts_with("BZh")) return Packing::kBzip2;
    return Packing::kPlain;
}

std::unique_ptr<MemberUnpacker> unpacker_of(Packing packing) {
    assert(packing != Packing::kPlain);
    if (packing == Packing::kGzip) return std::make_unique<GzipUnpacker>();
    return std::make_unique<Bzip2Unpacker>();
}

} // namespace scanloom::robot
