#include "tests/bench/projection/peers.hpp"

namespace scanloom::bench {

std::vector<Peer> mrpt_peer() { return {}; }

} // namespace scanloom::bench
