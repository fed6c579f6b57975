#pragma once

#include "common/scan/log_entry.hpp"
#include "server/mapping/layer.hpp"
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

enum class TileFormat : std::uint8_t { kCodes, kPng };

/// Which tile of which maps, in which form. What it shows depends on its revision besides, and on nothing else.
struct TilePlace {
    std::string maps; ///< a tag that no other maps have
    mapping::Layer layer = mapping::Layer::kOccupancy;
    TileKey key;
    TileFormat format = TileFormat::kPng;

    friend bool operator==(const TilePlace&, const TilePlace&) = default;
};

/// A tile as it is, or was.
struct KeptTile {
    SharedBytes bytes; ///< null: there is none
    Revision revision = 0;
    std::weak_ptr<const void> origin{}; ///< what made the maps it is of
};

/// Tiles that were made, each in the newest revision that was asked for; the least recently used go when others need
/// their room.
///
/// Memory  bytes_max for what is kept, its administration included; besides, what is being made or sent.
/// Thread  any. A lock is held to look and to note, never while a tile is made.
class TileCache {
public:
    struct Stats {
        std::uint64_t hits = 0;   ///< asked for and there, or being made for somebody else
        std::uint64_t misses = 0; ///< made
        std::size_t tiles = 0;
        std::size_t bytes = 0;
    };

    explicit TileCache(std::size_t bytes_max) : bytes_max_(bytes_max) {}

    /// The tile in that revision; null when it is not there.
    [[nodiscard]] SharedBytes find(const TilePlace& place, Revision revision);

    /// The same, made when it is not there. Of those who ask at the same time one makes it and the others wait for it;
    /// what `make` throws, all of them throw.
    [[nodiscard]] SharedBytes get(const TilePlace& place, Revision revision, const std::function<KeptTile()>& make);

    /// The tile in whatever revision is there, to be used for another; this counts as no request.
    [[nodiscard]] KeptTile newest(const TilePlace& place);

    /// Keeps a tile unless a newer revision is there, or memory is short.
    void keep(const TilePlace& place, KeptTile tile);

    /// Drops the tiles of these maps, and of those whose tags are theirs with "-" and more. One that is being made is
    /// not kept.
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
    struct Flight {
        TilePlace place;
        Revision revision;
        std::promise<SharedBytes> promise{};
        std::shared_future<SharedBytes> landed = promise.get_future().share();
        bool is_forgotten = false;
    };

    // With the lock held.
    [[nodiscard]] Entry* touch(const TilePlace& place);
    [[nodiscard]] SharedBytes find_locked(const TilePlace& place, Revision revision);
    void keep_locked(const TilePlace& place, KeptTile tile);
    void drop(std::list<Entry>::iterator entry);

    const std::size_t bytes_max_;
    mutable std::mutex mutex_;
    std::list<Entry> used_; // the newest use first
    Entries entries_;
    std::list<Flight> flights_;
    Stats stats_;
};

} // namespace scanloom::tiles
