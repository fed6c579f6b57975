#include "server/sessions/imported_map.hpp"

#include "core/mapping/reach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

namespace scanloom::sessions {
namespace {

Result<> check_patches(const mapping::MapConfig& config, const std::vector<MapPatch>& patches, const Creator& creator) {
    if (patches.empty()) return Error{Errc::kInvalidField, "the map has no cells"};
    grid::CellBox cells;
    for (const auto& patch : patches) {
        const auto reach = mapping::reach_of(config, patch);
        if (auto ok = mapping::check_work(reach); !ok) return ok;
        cells.include(reach.cells);
    }
    if (mapping::chunk_count_of(cells) <= static_cast<std::int64_t>(creator.chunks_max)) return {};
    const auto whose = creator.chunks_max == SessionLimits::kMost
                           ? std::string("a session can have")
                           : fmt::format("the limit `cells` of the token '{}' allows", creator.token);
    return Error{Errc::kFull, fmt::format("the map has {} x {} cells of {} metres, more than {}; use larger cells",
                                          cells.width(), cells.height(), config.cell_size, whose)};
}

std::int64_t pages_of(const mapping::MapConfig& config, const MapPatch& patch) {
    const bool is_known = std::ranges::any_of(patch.cells, [](MapCell cell) { return cell != MapCell::kUnknown; });
    return is_known ? mapping::chunk_count_of(mapping::reach_of(config, patch).cells) : 0;
}

/// @param free,most  free pages and size of the memory for maps
Error no_room(std::int64_t pages, std::int64_t free, std::int64_t most) {
    const auto mebibytes = [](std::int64_t count) {
        return count * static_cast<std::int64_t>(mapping::kPageBytes) >> 20;
    };
    if (pages > most) {
        return {Errc::kFull, fmt::format("this map takes up to {} MiB, and the memory for maps has {} MiB in all; use "
                                         "larger cells, or raise the server's --map-memory",
                                         mebibytes(pages), mebibytes(most))};
    }
    return {Errc::kOverloaded, fmt::format("there is no room for this map in the memory for maps: it takes up to {} "
                                           "MiB, and {} MiB are free; try again soon, or use larger cells",
                                           mebibytes(pages), mebibytes(free))};
}

} // namespace

std::size_t pages_of_imported(const mapping::MapConfig& config, const std::vector<MapPatch>& patches) {
    std::int64_t pages = 0;
    grid::CellBox cells;
    for (const auto& patch : patches) {
        pages += pages_of(config, patch); // counts pages that two patches share twice
        cells.include(mapping::reach_of(config, patch).cells);
    }
    return static_cast<std::size_t>(std::min(pages, mapping::chunk_count_of(cells)));
}

Result<mapping::Projection> integrate_imported(const mapping::MapConfig& config, const std::vector<MapPatch>& patches,
                                               const Creator& creator, limits::MemoryShare& share) {
    if (auto ok = check_patches(config, patches, creator); !ok) return ok.error();
    const std::int64_t free = share.free();
    try {
        mapping::Projection projection(config);
        for (const auto& patch : patches) {
            const std::int64_t pages = pages_of(config, patch);
            if (!share.take(pages)) {
                return no_room(static_cast<std::int64_t>(pages_of_imported(config, patches)), free, share.most());
            }
            const std::size_t before = projection.page_count();
            if (auto applied = projection.apply(patch); !applied) return applied.error();
            share.give_back(pages - static_cast<std::int64_t>(projection.page_count() - before));
        }
        static_cast<void>(projection.snapshot()); // computes the classes, which may run out of memory
        return projection;
    } catch (const std::bad_alloc&) {
        return Error{Errc::kOverloaded, "there is no memory left for this map; use larger cells"};
    }
}

} // namespace scanloom::sessions
