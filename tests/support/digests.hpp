#pragma once

#include "core/mapping/snapshot.hpp"

#include <string>

namespace scanloom::testing_support {

/// Returns a digest of every layer. Two results are equal only if all layers are equal.
inline std::string digests_of(const mapping::Snapshot& snapshot) {
    std::string digests;
    for (const auto layer : mapping::kLayers) {
        digests.append(mapping::name_of(layer)).append(" ").append(mapping::digest_of(snapshot, layer)).append("\n");
    }
    return digests;
}

} // namespace scanloom::testing_support
