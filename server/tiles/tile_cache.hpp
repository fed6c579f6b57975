#pragma once

#include "common/scan/log_entry.hpp"
#include "core/mapping/layer.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/tile_key.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>

namespace scanloom::tiles {

/// The form of a cached tile: its codes (see Code) or a PNG.
enum class TileFormat : std::uint8_t { kCodes, kPng };

/// Identifies a tile, its maps and its format. The bytes of a tile depend on its place and its revision only.
struct TilePlace {
    std::string maps; ///< a tag unique to these maps
    mapping::Layer layer = mapping::Layer::kOccupancy;
    TileKey key;
    TileFormat format = TileFormat::kPng;

    friend bool operator==(const TilePlace&, const TilePlace&) = default;
};

/// A cached tile at one revision.
struct KeptTile {
    SharedBytes bytes; ///< null: no tile
    Revision revision = 0;
    std::weak_ptr<const void> origin{}; ///< the session or replay job that produced the maps
};

/// A cache of tiles with the newest requested revision of each. Evicts the least recently used tiles when it is full.
///
/// Memory: bytes_max for cached tiles, including bookkeeping; tiles that are being made or sent are not counted.
/// Threads: any thread. The lock is held for lookup and insertion, not while a tile is made.
class TileCache {
public:
    struct Stats {
        std::uint64_t hits = 0;   ///< requests for a tile that was cached or already being made
        std::uint64_t misses = 0; ///< tiles made
        std::size_t tiles = 0;
        std::size_t bytes = 0;
    };

    explicit TileCache(std::size_t bytes_max) : bytes_max_(bytes_max) {}

    /// Returns the tile at that revision, or null if it is not cached.
    [[nodiscard]] SharedBytes find(const TilePlace& place, Revision revision);

    /// Returns the tile at that revision; makes it with `make` if it is not cached. Of simultaneous requests for the
    /// same tile, one makes it and the others wait for it.
    ///
    /// If `make` throws, all of these requests throw the same exception.
    [[nodiscard]] SharedBytes get(const TilePlace& place, Revision revision, const std::function<KeptTile()>& make);

    /// Returns the newest cached revision of the tile, as a basis for drawing another; KeptTile{} if there is none.
    /// Does not count as a request.
    [[nodiscard]] KeptTile newest(const TilePlace& place);

    /// Adds a tile to the cache, unless the cache has the same or a newer revision or memory is short.
    void keep(const TilePlace& place, KeptTile tile);

    /// Removes the tiles of these maps, and of maps whose tags consist of this tag, "-" and more. A tile of theirs that
    /// is being made is not cached.
    void forget(std::string_view maps);

    [[nodiscard]] Stats stats() const;

private:
    struct PlaceHash {
        [[nodiscard]] std::size_t operator()(const TilePlace& place) const noexcept;
    };

    struct Entry {
        const TilePlace* place; // in entries_
        KeptTile tile;
    };
    using Entries = std::unordered_map<TilePlace, std::list<Entry>::iterator, PlaceHash>;

    /// A tile that is being made.
    struct PendingTile {
        TilePlace place;
        Revision revision;
        std::promise<SharedBytes> promise{};
        std::shared_future<SharedBytes> result = promise.get_future().share();
        bool is_forgotten = false;
    };

    // Called with the lock held.
    [[nodiscard]] Entry* touch(const TilePlace& place);
    [[nodiscard]] SharedBytes find_locked(const TilePlace& place, Revision revision);
    void keep_locked(const TilePlace& place, KeptTile tile);
    void drop(std::list<Entry>::iterator entry);

    const std::size_t bytes_max_;
    mutable std::mutex mutex_;
    std::list<Entry> used_; // most recently used first
    Entries entries_;
    std::list<PendingTile> pending_;
    Stats stats_;
};

} // namespace scanloom::tiles
