#include "server/live/core/landmark_news.hpp"

#include <algorithm>
#include <functional>

namespace scanloom::live {

LandmarkNews news_in(const landmarks::LandmarkView& landmarks, LandmarkPlace told, std::size_t most) {
    LandmarkNews news;
    for (const auto& block : landmarks.blocks()) {
        if (block->revision < told.last) continue;
        for (const auto& one : block->landmarks) {
            if (place_of(one) > told) news.first.push_back(&one);
        }
    }
    const std::size_t count = std::min(most, news.first.size());
    const auto end = news.first.begin() + static_cast<std::ptrdiff_t>(count);
    std::ranges::partial_sort(news.first, end, std::less(), [](const auto* one) { return place_of(*one); });
    news.following = news.first.size() - count;
    news.first.resize(count);
    return news;
}

} // namespace scanloom::live
