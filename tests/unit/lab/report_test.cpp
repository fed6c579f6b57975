#include "lab/report.hpp"

#include "lab/markdown.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

/// Returns one result per run of the matrix; the k-th result has scores of k thousandths.
std::vector<RunResult> results_for(const Matrix& matrix, double milliseconds) {
    std::vector<RunResult> results;
    for (const Start& start : matrix.starts) {
        for (const double cell_size : matrix.cell_sizes) {
            for (const Scene& scene : matrix.scenes) {
                for (const NoiseChoice& noise : matrix.noises) {
                    for (const RayModelChoice& ray_model : matrix.ray_models) {
                        RunResult result{{scene, cell_size, ray_model, noise, start}, {}, 5, 0, "", {}};
                        result.scores.precision = static_cast<double>(results.size()) / 1000.0;
                        result.scores.residue = results.size();
                        result.times = {milliseconds, milliseconds, milliseconds};
                        if (is_pictured(matrix, result.spec)) result.picture = name_of(result.spec) + ".png";
                        results.push_back(result);
                    }
                }
            }
        }
    }
    return results;
}

std::size_t count_of(std::string_view text, std::string_view word) {
    std::size_t count = 0;
    for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) ++count;
    return count;
}

TEST(Report, ContainsEveryRunOnceAndEveryPicture) {
    const Matrix matrix = full_matrix();
    const auto results = results_for(matrix, 1.0);
    ASSERT_EQ(results.size(), matrix.run_count());
    const auto text = report_of(matrix, results);
    const auto models = matrix.ray_models.size();
    EXPECT_EQ(count_of(text, " | gaussian | "), 16U * models);
    EXPECT_EQ(count_of(text, " | north_east | "), 32U * models);
    EXPECT_EQ(count_of(text, "!["), 8U * models + 6U * models);
    EXPECT_THAT(text, HasSubstr("(pictures/static_0.01_inverse_sensor_model_none_south_west.png)"));
    EXPECT_THAT(text, HasSubstr("(pictures/dynamic_0.05_inverse_sensor_model_3_cells_south_west.png)"));
}

TEST(Report, SummaryIsTheMeanOverStartsWithoutNoise) {
    Matrix matrix = quick_matrix();
    matrix.starts = full_matrix().starts;
    matrix.cell_sizes = {0.1};
    matrix.scenes.resize(1);
    matrix.ray_models.resize(1);
    auto results = results_for(matrix, 1.0);
    ASSERT_EQ(results.size(), 4U);
    results[0].scores.recall = 0.25;
    results[1].scores.recall = 0.9; // with noise
    results[2].scores.recall = 0.75;
    EXPECT_THAT(report_of(matrix, results), HasSubstr("| static | 0.1 m | inverse_sensor_model | 0.001 | 0.500 |"));
}

TEST(Report, IsIndependentOfTimes) {
    const Matrix matrix = full_matrix();
    EXPECT_EQ(to_html(report_of(matrix, results_for(matrix, 1.0))),
              to_html(report_of(matrix, results_for(matrix, 2.0))));
    const auto times = times_report_of(matrix, results_for(matrix, 1.25), "a PDP-11");
    EXPECT_THAT(times, HasSubstr("| 0.01 m | inverse_sensor_model | 1.250 | 1.250 | 1.250 | 80 |"));
    EXPECT_THAT(times, HasSubstr("| static_0.1_inverse_sensor_model_none_south_west | 1.250 | 1.250 | 1.250 |"));
    EXPECT_THAT(times, HasSubstr("Measured on: a PDP-11."));
    EXPECT_EQ(count_of(times, "\n| static_") + count_of(times, "\n| dynamic_"), matrix.run_count());
}

} // namespace
} // namespace scanloom::lab
