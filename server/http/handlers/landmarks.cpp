#include "server/http/handlers/landmarks.hpp"

#include "server/http/geojson.hpp"
#include "server/http/handlers/bbox.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/landmarks/matching.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

constexpr std::size_t kLandmarkTextBytes = 320;

/// Selects landmarks.
struct LandmarkQuery {
    Revision since = 0;
    std::optional<tiles::Extent> bbox;
    std::uint32_t seen_min = 1;

    [[nodiscard]] bool wants(const landmarks::MapLandmark& one) const {
        const auto& at = one.landmark.position;
        const bool inside =
            !bbox || (at.x >= bbox->min_x && at.x <= bbox->max_x && at.y >= bbox->min_y && at.y <= bbox->max_y);
        return one.last > since && one.seen >= seen_min && inside;
    }
};

Result<std::uint32_t> seen_min_parameter(const Query& query) {
    const auto text = query.find("seen_min");
    if (!text) return std::uint32_t{1};
    const auto number = parse_integer<std::uint32_t>(*text);
    if (number && *number > 0) return *number;
    return Error{Errc::kInvalidField, fmt::format("seen_min is {}; a whole number from 1 to {} is needed",
                                                  in_quotes(*text), std::numeric_limits<std::uint32_t>::max())};
}

double rounded(double ratio) { return std::round(ratio * 1e4) / 1e4; }

boost::json::value mean(double sum, std::uint64_t count) {
    if (count == 0) return nullptr;
    return rounded(sum / static_cast<double>(count));
}

std::string feature_of(const landmarks::MapLandmark& one) {
    const auto& landmark = one.landmark;
    return feature({{"seen", one.seen},
                    {"points", landmark.points},
                    {"size", position(landmark.size)},
                    {"spread", rounded_metres(landmark.spread)},
                    {"continuity", rounded(landmark.continuity)},
                    {"first", one.first},
                    {"last", one.last}},
                   point_geometry(landmark.position), one.id);
}

} // namespace

Result<Response> get_landmarks(session::SessionRegistry& sessions, session::LandmarkFolds& folds,
                               const AnswerSlots& slots, const Call& call) {
    if (auto known = call.query.check_only({"since", "bbox", "seen_min"}); !known) return known.error();
    const auto since = since_parameter(call.query);
    if (!since) return since.error();
    const auto bbox = bbox_parameter(call.query);
    if (!bbox) return bbox.error();
    if (*bbox && ((*bbox)->min_x > (*bbox)->max_x || (*bbox)->min_y > (*bbox)->max_y)) {
        return Error{Errc::kInvalidField, "bbox is empty: min_x,min_y,max_x,max_y in metres, the smaller ones first"};
    }
    const auto seen_min = seen_min_parameter(call.query);
    if (!seen_min) return seen_min.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();

    const auto snapshot = (*session)->snapshot();
    const auto folded = folds.up_to((*session)->info(), snapshot->revision, [&] { return !sessions.is_draining(); });
    if (!folded) return folded.error();
    const LandmarkQuery asked{since_in(*snapshot, *since), *bbox, *seen_min};
    std::vector<const landmarks::MapLandmark*> wanted;
    for (const auto& block : folded->state.landmarks.blocks()) {
        if (block->revision <= asked.since) continue;
        for (const auto& one : block->landmarks) {
            if (asked.wants(one)) wanted.push_back(&one);
        }
    }
    auto slot = slots.take(wanted.size() * kLandmarkTextBytes);
    if (!slot) return slot.error();
    std::vector<std::string> features;
    features.reserve(wanted.size());
    for (const auto* one : wanted) features.push_back(feature_of(*one));
    const auto& sums = folded->state.sums;
    return ok_text(kGeoJson, std::move(*slot),
                   collection_document(folded->revision,
                                       {{"reset", asked.since != *since},
                                        {"captures", folded->state.captures},
                                        {"landmarks", folded->state.landmarks.size()},
                                        {"tolerance", landmarks::kTolerance},
                                        {"persistence", mean(sums.persistence, sums.persistence_pairs)},
                                        {"stability", mean(sums.stability, sums.stability_pairs)},
                                        {"continuity", mean(sums.continuity, sums.landmarks)}},
                                       features));
}

} // namespace scanloom::http
