#include "lab/experiment.hpp"
#include "lab/map_cells.hpp"
#include "lab/report.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <map>
#include <ostream>

namespace scanloom::lab {

void PrintTo(const Scores& scores, std::ostream* out) {
    *out << fmt::format("precision {:.3f} recall {:.3f} iou {:.3f} exact {:.3f} free {:.3f} residue {}",
                        scores.precision, scores.recall, scores.iou, scores.iou_exact, scores.free_recall,
                        scores.residue);
}

namespace {

/// Limits that every run of the quick matrix meets, for every ray model. The worst measured values: recall 0.857, exact
/// IoU 0.671; for static scenes precision 1.000 and free recall 0.989, with the walker (0.5 m cells, some of them
/// filled by him) 0.935 and 0.926.
bool is_good(const Scores& scores, bool is_still) {
    const bool is_true = is_still ? scores.precision > 0.99 && scores.free_recall > 0.97 && scores.residue == 0
                                  : scores.precision > 0.92 && scores.free_recall > 0.91 && scores.residue < 15;
    return is_true && scores.recall > 0.83 && scores.iou_exact > 0.65;
}

struct Everything {
    std::vector<RunResult> results;
    std::map<std::string, tiles::Bytes> pictures;
    std::size_t scans_reported = 0;
};

Everything run(const Matrix& matrix) {
    Everything everything;
    double clock = 0.0;
    const auto keep = [&](const std::string& file, const tiles::Bytes& png) -> Result<> {
        everything.pictures[file] = png;
        return {};
    };
    const auto count = [&](const RunSpec&, std::size_t, std::size_t scans) { everything.scans_reported = scans; };
    auto results = run_experiment(matrix, {[&] { return clock += 0.001; }, keep, count});
    EXPECT_TRUE(results);
    everything.results = std::move(*results);
    return everything;
}

TEST(Experiment, EveryRunOfTheQuickMatrixMeetsTheLimits) {
    const Matrix matrix = quick_matrix();
    const auto everything = run(matrix);
    ASSERT_EQ(everything.results.size(), matrix.run_count());
    EXPECT_EQ(everything.scans_reported, matrix.run_count() * matrix.scans);
    for (const RunResult& result : everything.results) {
        EXPECT_TRUE(is_good(result.scores, result.spec.scene.name == "static"))
            << name_of(result.spec) << ": " << testing::PrintToString(result.scores);
        EXPECT_NEAR(result.times.mean, 1.0, 1e-6);
        EXPECT_NEAR(result.times.percentile_95, 1.0, 1e-6);
    }
}

TEST(Experiment, TheReportDependsOnTheSeedOnly) {
    Matrix matrix = quick_matrix();
    matrix.scans = 60;
    const auto report = [&](const Everything& of) { return report_of(matrix, of.results); };
    const auto first = run(matrix);
    const auto again = run(matrix);
    EXPECT_EQ(report(first), report(again));
    EXPECT_EQ(first.pictures, again.pictures);
    EXPECT_EQ(first.pictures.size(), 4U * matrix.ray_models.size());
    matrix.seed = 2;
    EXPECT_NE(report(first), report(run(matrix)));
}

/// Faults of a model that the limits must detect.
class BrokenModels : public testing::Test {
protected:
    const Matrix matrix_ = quick_matrix();
    const double cell_size_ = 0.1;
    const std::vector<Pose2> path_ = drive_from(matrix_.starts[0], matrix_.scans);
    const Standard standard_ = make_standard(path_, cell_size_);

    Recording recording() const { return record(matrix_.scenes[0], path_, matrix_.noises[0], cell_size_, 1); }

    StateGrid map_of(const Recording& recording, SessionOptions options = {}) const {
        options.cell_size = cell_size_;
        mapping::Snapshot end;
        const auto keep = [&](std::size_t scans, mapping::Projection& projection) {
            if (scans == recording.scans.size()) end = projection.snapshot();
        };
        EXPECT_TRUE(integrate_recording(
            recording, options, [] { return 0.0; }, keep));
        return states_of(occupancy_of(end, standard_.truth.box));
    }

    Scores scores_of(const StateGrid& map) const {
        return score(map, standard_.truth, standard_.seen, CellMask(standard_.truth.box, 0));
    }
};

TEST_F(BrokenModels, AnIntactModelMeetsTheLimits) { EXPECT_TRUE(is_good(scores_of(map_of(recording())), true)); }

TEST_F(BrokenModels, SwappedFreeAndOccupiedIsDetected) {
    StateGrid map = map_of(recording());
    for (CellState& state : map.values) {
        if (state != CellState::kUnknown) state = state == CellState::kFree ? CellState::kOccupied : CellState::kFree;
    }
    EXPECT_FALSE(is_good(scores_of(map), true));
}

TEST_F(BrokenModels, TooThickWallsAreDetected) {
    SessionOptions thick;
    thick.obstacle_thickness = 0.5;
    EXPECT_FALSE(is_good(scores_of(map_of(recording(), thick)), true));
    SessionOptions fat;
    fat.ray_model = RayModel::kBresenham;
    fat.hit_radius = 0.3;
    EXPECT_FALSE(is_good(scores_of(map_of(recording(), fat)), true));
}

TEST_F(BrokenModels, TooWeakHitsAreDetected) {
    SessionOptions faint;
    faint.p_occupied = 0.51;
    EXPECT_FALSE(is_good(scores_of(map_of(recording(), faint)), true));
}

TEST_F(BrokenModels, TooWeakMissesAreDetected) {
    SessionOptions faint;
    faint.p_free = 0.4995;
    EXPECT_FALSE(is_good(scores_of(map_of(recording(), faint)), true));
}

TEST_F(BrokenModels, AMapThatIsNeverClearedIsDetectedByTheWalkersTraces) {
    const Recording walked = record(matrix_.scenes[1], path_, matrix_.noises[0], cell_size_, 1);
    const auto scores_with = [&](const SessionOptions& options) {
        mapping::Snapshot end;
        const auto keep = [&](std::size_t scans, mapping::Projection& projection) {
            if (scans == walked.scans.size()) end = projection.snapshot();
        };
        SessionOptions sized = options;
        sized.cell_size = cell_size_;
        EXPECT_TRUE(integrate_recording(
            walked, sized, [] { return 0.0; }, keep));
        return score(states_of(occupancy_of(end, standard_.truth.box)), standard_.truth, standard_.seen,
                     walked_cells(walked, end.config, standard_.truth.box));
    };
    EXPECT_TRUE(is_good(scores_with({}), false));
    SessionOptions once_and_for_all;
    once_and_for_all.p_free = 0.499;
    once_and_for_all.p_occupied = 0.95;
    const Scores scores = scores_with(once_and_for_all);
    EXPECT_FALSE(is_good(scores, false)) << testing::PrintToString(scores);
    EXPECT_GE(scores.residue, 15U);
}

TEST_F(BrokenModels, AShiftByOneCellInAnyDirectionIsDetected) {
    for (const auto& [dx, dy] : {std::pair{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
        Recording shifted = recording();
        for (Scan& scan : shifted.scans) {
            scan.pose->x += dx * cell_size_;
            scan.pose->y += dy * cell_size_;
        }
        EXPECT_FALSE(is_good(scores_of(map_of(shifted)), true))
            << dx << ' ' << dy << ": " << testing::PrintToString(scores_of(map_of(shifted)));
    }
}

TEST_F(BrokenModels, AnIgnoredHeadingIsDetected) {
    Recording turned = recording();
    for (Scan& scan : turned.scans) scan.pose->yaw = 0.0;
    EXPECT_FALSE(is_good(scores_of(map_of(turned)), true));
}

TEST_F(BrokenModels, AMirroredLaserIsDetected) {
    Recording mirrored = recording();
    for (Scan& scan : mirrored.scans) std::reverse(scan.ranges.begin(), scan.ranges.end());
    EXPECT_FALSE(is_good(scores_of(map_of(mirrored)), true));
}

} // namespace
} // namespace scanloom::lab
