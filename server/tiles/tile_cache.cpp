#include "server/tiles/tile_cache.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace scanloom::tiles {
namespace {

constexpr std::size_t kAdministrationBytes = 320; // per tile: its place, two nodes, its control block

std::size_t size_of(const TilePlace& place, const KeptTile& tile) {
    return tile.bytes->capacity() + place.maps.capacity() + kAdministrationBytes;
}

bool is_of(std::string_view tag, std::string_view maps) {
    return tag.starts_with(maps) && (tag.size() == maps.size() || tag[maps.size()] == '-');
}

} // namespace

std::size_t TileCache::PlaceHash::operator()(const TilePlace& place) const noexcept {
    constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15; // 2^64 / golden ratio
    const auto& [zoom, x, y] = place.key;
    const std::uint64_t where = std::uint64_t{x} << 32 | std::uint64_t{y} << 16 | std::uint64_t{zoom} << 8 |
                                static_cast<std::uint64_t>(place.layer) << 4 | static_cast<std::uint64_t>(place.format);
    const std::uint64_t mixed = (std::hash<std::string_view>{}(place.maps) ^ where) * kOdd;
    return mixed ^ mixed >> 32;
}

SharedBytes TileCache::find(const TilePlace& place, Revision revision) {
    const std::lock_guard lock(mutex_);
    auto found = find_locked(place, revision);
    if (found) ++stats_.hits;
    return found;
}

SharedBytes TileCache::get(const TilePlace& place, Revision revision, const std::function<KeptTile()>& make) {
    std::unique_lock lock(mutex_);
    if (auto found = find_locked(place, revision)) {
        ++stats_.hits;
        return found;
    }
    const auto other = std::ranges::find_if(
        pending_, [&](const PendingTile& pending) { return pending.revision == revision && pending.place == place; });
    if (other != pending_.end()) {
        ++stats_.hits;
        const auto result = other->result;
        lock.unlock();
        return result.get();
    }
    ++stats_.misses;
    const auto pending = pending_.insert(pending_.end(), PendingTile{place, revision});
    lock.unlock();
    KeptTile made;
    try {
        made = make();
    } catch (...) {
        lock.lock();
        pending->promise.set_exception(std::current_exception());
        pending_.erase(pending);
        throw;
    }
    lock.lock();
    auto bytes = made.bytes;
    const bool is_forgotten = pending->is_forgotten;
    pending->promise.set_value(bytes);
    pending_.erase(pending);
    if (!is_forgotten) keep_locked(place, std::move(made));
    return bytes;
}

KeptTile TileCache::newest(const TilePlace& place) {
    const std::lock_guard lock(mutex_);
    const Entry* entry = touch(place);
    return entry == nullptr ? KeptTile{} : entry->tile;
}

void TileCache::keep(const TilePlace& place, KeptTile tile) {
    const std::lock_guard lock(mutex_);
    keep_locked(place, std::move(tile));
}

void TileCache::forget(std::string_view maps) {
    const std::lock_guard lock(mutex_);
    for (auto entry = used_.begin(); entry != used_.end();) {
        const auto next = std::next(entry);
        if (is_of(entry->place->maps, maps)) drop(entry);
        entry = next;
    }
    for (auto& pending : pending_) pending.is_forgotten = pending.is_forgotten || is_of(pending.place.maps, maps);
}

TileCache::Stats TileCache::stats() const {
    const std::lock_guard lock(mutex_);
    Stats stats = stats_;
    stats.tiles = entries_.size();
    return stats;
}

TileCache::Entry* TileCache::touch(const TilePlace& place) {
    const auto found = entries_.find(place);
    if (found == entries_.end()) return nullptr;
    used_.splice(used_.begin(), used_, found->second);
    return &*found->second;
}

SharedBytes TileCache::find_locked(const TilePlace& place, Revision revision) {
    const Entry* entry = touch(place);
    return entry != nullptr && entry->tile.revision == revision ? entry->tile.bytes : nullptr;
}

void TileCache::keep_locked(const TilePlace& place, KeptTile tile) {
    if (const auto found = entries_.find(place); found != entries_.end()) {
        if (found->second->tile.revision >= tile.revision) return;
        drop(found->second);
    }
    const std::size_t size = size_of(place, tile);
    if (size > bytes_max_) return;
    while (stats_.bytes + size > bytes_max_) drop(std::prev(used_.end()));
    try {
        std::list<Entry> added;
        added.push_back({nullptr, std::move(tile)});
        const auto [entry, inserted] = entries_.try_emplace(place, added.begin());
        added.front().place = &entry->first;
        used_.splice(used_.begin(), added); // no exceptions from here on
        stats_.bytes += size_of(entry->first, entry->second->tile);
    } catch (const std::bad_alloc&) { // both lists are unchanged; the caller still gets the tile
    }
}

void TileCache::drop(std::list<Entry>::iterator entry) {
    stats_.bytes -= size_of(*entry->place, entry->tile);
    entries_.erase(entries_.find(*entry->place));
    used_.erase(entry);
}

} // namespace scanloom::tiles
