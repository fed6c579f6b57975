#pragma once

#include "common/scan/class_source.hpp"
#include "common/scan/ray_model.hpp"

#include <cstdint>
#include <optional>

namespace scanloom {

/// The requested settings of a session's maps; an absent setting takes its default. settings.def documents each.
struct SessionOptions {
#define SCANLOOM_SETTING(type, name, ...) std::optional<type> name;
#include "common/scan/settings.def"

    friend bool operator==(const SessionOptions&, const SessionOptions&) = default;
};

} // namespace scanloom
