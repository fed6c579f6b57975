#include "server/sessions/checkpoint_parts.hpp"

#include <zstd.h>

#include <bit>
#include <new>
#include <type_traits>
#include <utility>
#include <variant>

namespace scanloom::sessions {
namespace {

constexpr int kLevel = 1; // cells repeat; higher levels gain little

} // namespace

void PartCompressor::Free::operator()(ZSTD_CCtx_s* context) const noexcept { ZSTD_freeCCtx(context); }

PartCompressor::PartCompressor() : context_(ZSTD_createCCtx()) {
    if (!context_) throw std::bad_alloc();
}

std::string PartCompressor::compressed(std::string_view bytes) {
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size =
        ZSTD_compressCCtx(context_.get(), out.data(), out.size(), bytes.data(), bytes.size(), kLevel);
    if (ZSTD_isError(size) != 0) throw std::bad_alloc(); // the buffer is large enough, so only memory can be missing
    return out.substr(0, size);
}

void PartDecompressor::Free::operator()(ZSTD_DCtx_s* context) const noexcept { ZSTD_freeDCtx(context); }

PartDecompressor::PartDecompressor() : context_(ZSTD_createDCtx()) {
    if (!context_) throw std::bad_alloc();
}

std::optional<std::string> PartDecompressor::decompressed(std::string_view bytes, std::size_t bytes_max) {
    const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
    if (size > bytes_max) return std::nullopt; // error codes are larger numbers
    std::string out(static_cast<std::size_t>(size), '\0');
    const std::size_t got = ZSTD_decompressDCtx(context_.get(), out.data(), out.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(got) != 0 || got != out.size()) return std::nullopt;
    return out;
}

namespace {

/// The stored form of an Exclusion.
struct StoredExclusion {
    std::uint64_t id;
    std::uint32_t robot;
    std::uint32_t is_of_seqs; // 0: a range of stamps
    std::uint64_t from;       // sequence number, or the bits of a stamp
    std::uint64_t to;
    Revision since;
    Revision lifted;
};
static_assert(std::has_unique_object_representations_v<StoredExclusion>, "no bytes of it are undefined");

StoredExclusion stored_form_of(const Exclusion& exclusion) {
    const auto& [id, robot, scans] = exclusion.excluded;
    if (const auto* seqs = std::get_if<SeqRange>(&scans)) {
        return {id, robot, 1, seqs->from, seqs->to, exclusion.since, exclusion.lifted};
    }
    const auto& stamps = std::get<StampRange>(scans);
    const auto bits_of = [](double stamp) { return std::bit_cast<std::uint64_t>(stamp); };
    return {id, robot, 0, bits_of(stamps.from), bits_of(stamps.to), exclusion.since, exclusion.lifted};
}

ScansExcluded excluded_of(const StoredExclusion& stored) {
    if (stored.is_of_seqs != 0) return {stored.id, stored.robot, SeqRange{stored.from, stored.to}};
    return {stored.id, stored.robot, StampRange{std::bit_cast<double>(stored.from), std::bit_cast<double>(stored.to)}};
}

} // namespace

std::string exclusions_part(const mapping::ProjectionState& state) {
    std::string value;
    put(value, std::uint64_t{state.exclusions->all().size()});
    for (const auto& exclusion : state.exclusions->all()) put(value, stored_form_of(exclusion));
    for (const auto& robot : state.robots) put(value, robot.excluded);
    return value;
}

std::optional<ExclusionsPart> read_exclusions_part(std::string_view value) {
    PartReader part(value);
    ExclusionsPart read;
    std::vector<std::pair<Revision, ExclusionLifted>> lifted;
    for (auto count = part.take<std::uint64_t>(); count > 0 && !part.failed(); --count) {
        const auto stored = part.take<StoredExclusion>();
        if (!read.exclusions.add(stored.since, excluded_of(stored))) return std::nullopt;
        if (stored.lifted != 0) lifted.emplace_back(stored.lifted, ExclusionLifted{stored.id});
    }
    for (const auto& [revision, which] : lifted) {
        if (!read.exclusions.add(revision, which)) return std::nullopt;
    }
    while (!part.complete() && !part.failed()) read.excluded.push_back(part.take<std::uint64_t>());
    if (part.failed()) return std::nullopt;
    return read;
}

} // namespace scanloom::sessions
