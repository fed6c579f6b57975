#include "lab/trial_report.hpp"

#include "tests/unit/lab/drawn_trials.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string text_of(const TrialResults& results) {
    Document document;
    add_trials(document, results);
    return to_markdown(document);
}

TEST(TrialReport, TablesCountVerdictsAndShowTheLargestRightErrors) {
    const auto text = text_of(drawn_trial_results());
    EXPECT_THAT(text,
                HasSubstr("| world | scenes | right | wrong | ambiguous | undetermined | worst mm | worst deg |"));
    EXPECT_THAT(text, HasSubstr("| room | 2 | 1 | 0 | 1 | 0 | 4.2 | 0.11 |"));
    EXPECT_THAT(text, HasSubstr("| office | 1 | 1 | 0 | 0 | 0 | 1 | - | - |")) << "an absent value is a dash";
    EXPECT_THAT(text, HasSubstr("| office | 4 | 3 | 1 | 2 | 0 | 0 | 4.2 | 0.11 |"));
    EXPECT_THAT(text, HasSubstr("| room | office | 4 | 3 | 1 | 1 | 1 |"));
    EXPECT_THAT(text, HasSubstr("within 2 cm and 0.5 degrees"));
}

TEST(TrialReport, EachWrongTrialIsListed) {
    const auto results = drawn_trial_results();
    EXPECT_THAT(alignment_trial_findings(results), ElementsAre("1 of 2 are right, and no clear result is wrong."));
    EXPECT_THAT(locating_trial_findings(results),
                ElementsAre("In maps of 1 capture 0 of 1 views are found, and no clear result is wrong.",
                            "In maps of 4 captures 1 of 3 views are found, and 2 of 3 clear results are wrong.",
                            "Wrong by more than 1 m, where the world is repetitive: 1 of 2; at the wrong place the "
                            "inlier ratio of these views is 0.80, at the true place 0.30.",
                            "Wrong, but near the ground truth: 1 of 2, off by 30.1 mm.",
                            "Wrong: office, map of 4 captures, scene 702, off by 30.1 mm and 5.73 degrees.",
                            "Wrong: office, map of 4 captures, scene 703, off by 2500.0 mm and 171.89 degrees."));
    EXPECT_THAT(
        stranger_findings(results),
        ElementsAre("2 of 3 are refused.",
                    "Clear, but the view is of another world: room in a map of the office of 4 captures, scene 703."));
}

TEST(TrialReport, ContainsThePictureIfDrawn) {
    auto results = drawn_trial_results();
    EXPECT_THAT(text_of(results), HasSubstr("![a view in a map of the office of 4 captures, scene 701: off by 4.2 mm "
                                            "and 0.11 degrees](pictures/l.png)"));
    results.picture.reset();
    EXPECT_THAT(text_of(results), Not(HasSubstr("![")));
}

TEST(TrialReport, TimesAreASeparateTable) {
    auto results = drawn_trial_results();
    Document times;
    add_trial_times(times, results);
    EXPECT_THAT(to_markdown(times), HasSubstr("| alignment, room | 2 | 2 | 1.5 | 750 |"));
    EXPECT_THAT(to_markdown(times), HasSubstr("| localization, office | 4 | 3 | 1.5 | 500 |"));
    EXPECT_THAT(to_markdown(times), HasSubstr("| room in the office | 4 | 3 | 1.5 | 500 |"));
    const auto text = text_of(results);
    for (auto& row : results.located) row.trials.seconds = 9.0;
    EXPECT_EQ(text_of(results), text);
}

} // namespace
} // namespace scanloom::lab
