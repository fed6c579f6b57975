#include "server/mapping/digest.hpp"

#include <boost/endian/buffers.hpp>
#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>

namespace scanloom::mapping {
namespace {

class Sha256 {
public:
    Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
        require(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
    }

    void update(std::span<const std::byte> bytes) {
        require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
    }

    [[nodiscard]] std::string hex() {
        std::array<unsigned char, 32> hash{};
        require(EVP_DigestFinal_ex(context_.get(), hash.data(), nullptr) == 1);
        std::string text;
        for (const unsigned char byte : hash) fmt::format_to(std::back_inserter(text), "{:02x}", byte);
        return text;
    }

private:
    /// OpenSSL refuses these calls only when memory is short or its installation lacks SHA-256.
    static void require(bool done) {
        if (!done) throw std::runtime_error("OpenSSL could not compute a SHA-256 digest");
    }

    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

struct CanonicalChunk {
    boost::endian::little_int32_buf_t ci;
    boost::endian::little_int32_buf_t cj;
    std::array<boost::endian::little_int16_buf_t, std::size_t{kChunkSide} * kChunkSide> cells;
};
static_assert(sizeof(CanonicalChunk) == 8 + 2 * 4096, "hashed as it lies in memory");

} // namespace

std::string digest_of(const OccupancyView& view) {
    std::vector<std::pair<ChunkKey, const OccupancyChunk*>> chunks;
    view.visit({}, 0, [&](ChunkKey key, const OccupancyChunk& chunk) {
        const auto is_known = [](LogOdds cell) { return cell != kUnknownLogOdds; };
        if (std::any_of(chunk.cells.begin(), chunk.cells.end(), is_known)) chunks.emplace_back(key, &chunk);
    });
    std::sort(chunks.begin(), chunks.end());

    Sha256 hash;
    CanonicalChunk canonical;
    for (const auto& [key, chunk] : chunks) {
        canonical.ci = key.ci;
        canonical.cj = key.cj;
        std::copy(chunk->cells.begin(), chunk->cells.end(), canonical.cells.begin());
        hash.update(std::as_bytes(std::span(&canonical, 1)));
    }
    return hash.hex();
}

} // namespace scanloom::mapping
