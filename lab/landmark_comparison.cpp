#include "lab/landmark_comparison.hpp"

#include "server/landmarks/matching.hpp"

namespace scanloom::lab {
namespace {

std::vector<landmarks::Continuity> continuity_of_each(std::span<const Point2> points,
                                                      const landmarks::LandmarkSurvey& survey) {
    std::vector<std::vector<Point2>> members(survey.landmarks.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto cluster = survey.clustering.cluster_of[n];
        if (cluster != landmarks::kNoise) members[static_cast<std::size_t>(cluster)].push_back(points[n]);
    }
    std::vector<landmarks::Continuity> continuity;
    continuity.reserve(members.size());
    for (const auto& cluster : members) continuity.push_back(landmarks::continuity_of(cluster, survey.eps));
    return continuity;
}

landmarks::Continuity mean_continuity(const SeenLandmarks& first, const SeenLandmarks& second) {
    const std::size_t count = first.continuity.size() + second.continuity.size();
    landmarks::Continuity mean;
    for (const auto* seen : {&first, &second}) {
        for (const auto& [linearity, evenness, fill] : seen->continuity) {
            mean.linearity += linearity / static_cast<double>(count);
            mean.evenness += evenness / static_cast<double>(count);
            mean.fill += fill / static_cast<double>(count);
        }
    }
    return mean;
}

} // namespace

Result<SeenLandmarks> see_landmarks(std::vector<Point2> points) {
    auto survey = landmarks::survey_landmarks(points);
    if (!survey) return survey.error();
    auto continuity = continuity_of_each(points, *survey);
    return SeenLandmarks{std::move(points), std::move(*survey), std::move(continuity)};
}

Result<Comparison> compare(const SeenLandmarks& first, const SeenLandmarks& second, double tolerance) {
    const auto& of_first = first.survey.landmarks;
    const auto& of_second = second.survey.landmarks;
    auto matches = landmarks::match(positions_of(of_first), positions_of(of_second), tolerance);
    if (!matches) return matches.error();
    Comparison comparison;
    comparison.metrics = landmarks::metrics_of(*matches, of_first.size(), tolerance);
    comparison.only_first = of_first.size() - matches->size();
    comparison.only_second = of_second.size() - matches->size();
    comparison.continuity = mean_continuity(first, second);
    comparison.matches = std::move(*matches);
    return comparison;
}

} // namespace scanloom::lab
