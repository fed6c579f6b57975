#include "tests/bench/projection/peers.hpp"

namespace scanloom::bench {

std::vector<Peer> mrpt_peer() { return {}; }

std::string mrpt_version() { return {}; }

} // namespace scanloom::bench
