#include "server/session/maker.hpp"

#include <algorithm>

namespace scanloom::session {
namespace {

constexpr std::size_t kCellsOfChunk = 64 * 64;

} // namespace

Maker maker_of(const access::Token& token) {
    const auto chunks = std::max<std::size_t>(1, token.limits.cells / kCellsOfChunk);
    return {token.name, token.limits.sessions, std::min(chunks, SessionLimits::kMost)};
}

} // namespace scanloom::session
