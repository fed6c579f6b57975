#include "server/sessions/session_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace scanloom::sessions {
namespace {

/// A bijection in which each input bit affects all output bits. Source: Steele, Lea, Flood (2014), SplitMix64.
std::uint64_t mixed(std::uint64_t bits) {
    bits += 0x9E37'79B9'7F4A'7C15U;
    bits = (bits ^ (bits >> 30)) * 0xBF58'476D'1CE4'E5B9U;
    bits = (bits ^ (bits >> 27)) * 0x94D0'49BB'1331'11EBU;
    return bits ^ (bits >> 31);
}

} // namespace

std::string tag_of(const SessionInfo& info) {
    return fmt::format("{:016x}", mixed(mixed(info.id) ^ std::bit_cast<std::uint64_t>(info.created)));
}

ScanFilter scan_filter_of(const SessionInfo& info) { return ScanFilter(info.config.max_jump, info.exclusions); }

Error shutting_down() { return {Errc::kShuttingDown, "the server is shutting down; try again when it is back"}; }

Creator creator_of(const auth::Token& token) {
    constexpr std::size_t kCellsOfChunk = 64 * 64;
    const auto chunks = std::max<std::size_t>(1, token.limits.cells / kCellsOfChunk);
    return {token.name, token.limits.sessions, std::min(chunks, SessionLimits::kMost)};
}

} // namespace scanloom::sessions
