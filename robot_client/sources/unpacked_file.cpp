#include "robot_client/sources/unpacked_file.hpp"

#include <algorithm>

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

UnpackedFile::UnpackedFile(const std::filesystem::path& path) : file_(path, std::ios::binary) {
    std::array<char, 3> first_bytes{};
    file_.read(first_bytes.data(), first_bytes.size());
    packing_ = packing_of({first_bytes.data(), static_cast<std::size_t>(file_.gcount())});
    file_.clear();
    file_.seekg(0);
}

std::optional<std::size_t> UnpackedFile::read(std::span<char> text) {
    if (packing_ == Packing::kPlain) return read_plain(text);
    while (!is_damaged_) {
        if (packed_.empty()) refill();
        if (!member_) {
            if (packed_.empty()) return 0;
            if (!is_first_member_ && packed_.front() == '\0') {
                is_damaged_ = !only_zeros_are_left();
                continue;
            }
            member_ = unpacker_of(packing_);
            is_first_member_ = false;
        }
        const Unpacked step = member_->step(packed_, text);
        packed_.remove_prefix(step.taken);
        const bool is_cut_short = step.taken == 0 && step.made == 0; // it needs more input and there is none
        is_damaged_ =
            step.state == Unpacked::State::kDamaged || (step.state == Unpacked::State::kGoesOn && is_cut_short);
        if (step.state == Unpacked::State::kEnded) member_.reset();
        if (step.made > 0) return step.made;
    }
    return std::nullopt;
}

void UnpackedFile::refill() {
    file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    packed_ = std::string_view(buffer_.data(), static_cast<std::size_t>(file_.gcount()));
    bytes_read_ += packed_.size();
}

std::size_t UnpackedFile::read_plain(std::span<char> text) {
    if (packed_.empty()) refill();
    const std::size_t count = packed_.copy(text.data(), text.size());
    packed_.remove_prefix(count);
    return count;
}

bool UnpackedFile::only_zeros_are_left() {
    while (!packed_.empty()) {
        if (std::ranges::any_of(packed_, [](char byte) { return byte != '\0'; })) return false;
        refill();
    }
    return true;
}

} // namespace scanloom::robot
