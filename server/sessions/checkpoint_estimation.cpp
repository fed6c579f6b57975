#include "server/sessions/checkpoint_estimation.hpp"

#include "common/archive/archive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace scanloom::sessions {
namespace {

constexpr std::size_t kScansOfBlock = 64;
constexpr std::size_t kPieceBytesMax = std::size_t{1} << 20; // before compression; a block of scans has less

// Keys after kEstimationPart
constexpr std::string_view kCorrection = "correction/"; // number and piece
constexpr std::string_view kScans = "scans/";           // block
constexpr std::string_view kState = "state/";           // slot and piece

using AddPart = std::function<void(std::string, std::string_view)>;

std::string part_name(std::string_view kind, std::size_t number) {
    return fmt::format("{}{}{:08x}", kEstimationPart, kind, number);
}

/// Adds bytes in pieces. @return their number
std::uint32_t add_pieces(std::string_view key, std::string_view bytes, const AddPart& add) {
    std::uint32_t pieces = 0;
    do {
        add(fmt::format("{}/{:08x}", key, pieces++), bytes.substr(0, kPieceBytesMax));
        bytes.remove_prefix(std::min(bytes.size(), kPieceBytesMax));
    } while (!bytes.empty());
    return pieces;
}

/// Returns the two numbers at the end of a key; the second is 0 if there is one only.
std::optional<std::array<std::uint32_t, 2>> piece_of(std::string_view key) {
    std::array<std::uint32_t, 2> numbers{};
    const auto slash = std::min(key.find('/'), key.size());
    const auto read = [](std::string_view text, std::uint32_t& number) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
        return error == std::errc{} && end == text.data() + text.size();
    };
    if (!read(key.substr(0, slash), numbers[0])) return std::nullopt;
    if (slash < key.size() && !read(key.substr(slash + 1), numbers[1])) return std::nullopt;
    return numbers;
}

bool is_possible(const EstimationHead& head) {
    return head.frame_origin <= FrameOrigin::kEstimated && head.slot <= 1 &&
           std::ranges::all_of(head.robots, [](const EstimationHead::Robot& robot) {
               return robot.poses <= Poses::kNone && robot.localization.state <= LocalizationState::kUnlocated;
           });
}

} // namespace

std::string estimation_head_part(const EstimationHead& head) {
    archive::Writer writer;
    writer(head);
    return std::move(writer).take();
}

Result<EstimationHead> read_estimation_head(std::string_view value) {
    const auto version = PartReader(value).take<std::uint32_t>();
    if (value.size() >= sizeof version && version != localization::kEstimationVersion) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("its poses were estimated by version {}, this program is of version {}", version,
                                 localization::kEstimationVersion)};
    }
    archive::Reader reader(value);
    EstimationHead head;
    reader(head);
    if (reader.complete() && is_possible(head)) return head;
    return Error{Errc::kMalformed, fmt::format("checkpoint part '{}' is damaged", kEstimationHead)};
}

EstimationHead add_estimation(const localization::EstimationState& state, const mapping::ProjectionState& maps,
                              const std::optional<EstimationHead>& stored, const AddPart& add) {
    EstimationHead head{.frame_origin = maps.frame_origin,
                        .scans = state.scans.size(),
                        .corrections = state.corrections.size(),
                        .slot = stored ? 1 - stored->slot : 0};
    for (std::size_t n = 0; n < maps.robots.size(); ++n) {
        head.robots.push_back({maps.robots[n].poses, maps.robots[n].unplaced, state.localization[n]});
    }
    for (std::size_t n = stored ? stored->corrections : 0; n < state.corrections.size(); ++n) {
        add_pieces(part_name(kCorrection, n), localization::bytes_of(*state.corrections[n]), add);
    }
    for (std::size_t block = stored ? stored->scans / kScansOfBlock : 0; block * kScansOfBlock < state.scans.size();
         ++block) {
        const std::size_t end = std::min(state.scans.size(), (block + 1) * kScansOfBlock);
        std::string scans;
        for (std::size_t n = block * kScansOfBlock; n < end; ++n) scans += localization::bytes_of(*state.scans[n]);
        add(part_name(kScans, block), scans);
    }
    head.pieces = add_pieces(part_name(kState, head.slot), state.bytes, add);
    return head;
}

bool EstimationReader::add(std::string_view key, std::string_view value, PartDecompressor& decompressor) {
    const auto kind = key.substr(0, key.find('/') + 1);
    const auto numbers = piece_of(key.substr(kind.size()));
    if (!numbers || (kind != kCorrection && kind != kScans && kind != kState)) return false;
    const auto [number, piece] = *numbers;
    const bool is_named = kind == kCorrection ? number < head_.corrections
                          : kind == kScans    ? number * kScansOfBlock < head_.scans
                                              : number == head_.slot && piece < head_.pieces;
    if (!is_named) return true;
    const auto bytes = decompressor.decompressed(value, kPieceBytesMax);
    if (!bytes) return false;
    if (kind == kCorrection) return add_correction(number, piece, *bytes);
    if (kind == kState) {
        state_.bytes += *bytes;
        return piece == pieces_++;
    }
    return number * kScansOfBlock == state_.scans.size() && localization::append_scans(*bytes, state_.scans);
}

bool EstimationReader::add_correction(std::uint32_t number, std::uint32_t piece, std::string_view bytes) {
    if (piece == 0 && !end_correction()) return false;
    correction_ += bytes;
    return number == state_.corrections.size() && piece == correction_pieces_++;
}

bool EstimationReader::end_correction() {
    if (correction_pieces_ == 0) return true;
    correction_pieces_ = 0;
    return localization::append_correction(std::exchange(correction_, {}), state_.corrections);
}

std::optional<localization::RestoredEstimation> EstimationReader::finish(mapping::ProjectionState& maps) && {
    const bool is_whole = end_correction() && state_.corrections.size() == head_.corrections &&
                          state_.scans.size() >= head_.scans && pieces_ == head_.pieces &&
                          head_.robots.size() == maps.robots.size();
    if (!is_whole) return std::nullopt;
    state_.scans.resize(head_.scans); // the last block may have more, of an interrupted checkpoint
    auto estimation = localization::restored(state_, maps);
    if (!estimation) return std::nullopt;
    maps.corrected = estimation->corrected;
    for (std::size_t n = 0; n < maps.robots.size(); ++n) {
        maps.robots[n].scan_poses = estimation->robots[n].poses.snapshot();
        maps.robots[n].turns = estimation->robots[n].turns;
    }
    return estimation;
}

} // namespace scanloom::sessions
