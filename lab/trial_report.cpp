#include "lab/trial_report.hpp"

#include "lab/each_index.hpp"
#include "lab/report.hpp"

#include "sim/noise.hpp"
#include "sim/standing_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

namespace scanloom::lab {
namespace {

using Cells = std::vector<std::string>;

std::string counted(std::size_t count) { return fmt::format("{}", count); }
std::string counted(const Trials& trials, Verdict verdict) { return counted(trials.count(verdict)); }

Cells with(Cells front, const Cells& back) {
    front.insert(front.end(), back.begin(), back.end());
    return front;
}

const Cells kVerdictHead{"scenes", "right", "wrong", "ambiguous", "undetermined", "worst mm", "worst deg"};

Cells verdict_cells(const Trials& trials) {
    const bool is_any_right = trials.count(Verdict::kRight) > 0;
    const PoseError worst = trials.worst();
    return {counted(trials.each.size()),
            counted(trials, Verdict::kRight),
            counted(trials, Verdict::kWrong),
            counted(trials, Verdict::kAmbiguous),
            counted(trials, Verdict::kUndetermined),
            is_any_right ? fmt::format("{:.1f}", worst.millimetres()) : "-",
            is_any_right ? fmt::format("{:.2f}", worst.degrees()) : "-"};
}

Table alignment_trial_table(const TrialResults& results) {
    Table table{with({"world"}, kVerdictHead), {}};
    for (const auto& [world, trials] : results.aligned) table.rows.push_back(with({world}, verdict_cells(trials)));
    return table;
}

Table locating_table(const TrialResults& results) {
    Table table{with({"world", "captures"}, kVerdictHead), {}};
    for (const auto& row : results.located) {
        table.rows.push_back(with({row.map, counted(row.captures)}, verdict_cells(row.trials)));
    }
    return table;
}

Table stranger_table(const TrialResults& results) {
    Table table{{"view of", "map of", "captures", "views", "clear", "ambiguous", "undetermined"}, {}};
    for (const auto& [seen, map, captures, trials] : results.strangers) {
        table.rows.push_back({seen, map, counted(captures), counted(trials.each.size()),
                              counted(trials, Verdict::kWrong), counted(trials, Verdict::kAmbiguous),
                              counted(trials, Verdict::kUndetermined)});
    }
    return table;
}

std::string wrong_text(std::size_t right, std::size_t wrong) {
    if (wrong == 0) return "no clear result is wrong";
    return fmt::format("{} of {} clear results {} wrong", wrong, right + wrong, wrong == 1 ? "is" : "are");
}

std::string captures_text(std::size_t captures) {
    return captures == 1 ? "1 capture" : fmt::format("{} captures", captures);
}

/// Clear results that are wrong, with their names.
class WrongOnes {
public:
    void add(const std::string& kind, const Trials& trials) {
        for (const Trial& trial : trials.each) {
            if (trial.verdict != Verdict::kWrong) continue;
            named_.push_back(fmt::format("Wrong: {}, scene {}, off by {:.1f} mm and {:.2f} degrees.", kind, trial.seed,
                                         trial.error.millimetres(), trial.error.degrees()));
            if (trial.explained_at_truth) {
                explained_.push_back(trial.explained);
                at_truth_.push_back(*trial.explained_at_truth);
            } else {
                nearby_.push_back(trial.error.millimetres());
            }
        }
    }

    /// Adds a summary and each result.
    void append_to(std::vector<std::string>& findings) const {
        if (!explained_.empty()) {
            findings.push_back(fmt::format("Wrong by more than {:g} m, where the world is repetitive: {} of {}; at the "
                                           "wrong place the inlier ratio of these views is {}, at the true place {}.",
                                           kElsewhere, explained_.size(), named_.size(), range_text(explained_, 2),
                                           range_text(at_truth_, 2)));
        }
        if (!nearby_.empty()) {
            findings.push_back(fmt::format("Wrong, but near the ground truth: {} of {}, off by {} mm.", nearby_.size(),
                                           named_.size(), range_text(nearby_, 1)));
        }
        findings.insert(findings.end(), named_.begin(), named_.end());
    }

private:
    std::vector<std::string> named_;
    std::vector<double> explained_; // of results in another place
    std::vector<double> at_truth_;
    std::vector<double> nearby_; // millimetres, of the other results
};

/// Totals over all worlds.
struct Sum {
    std::size_t scenes = 0;
    std::size_t right = 0;
    std::size_t wrong = 0;

    void add(const Trials& trials) {
        scenes += trials.each.size();
        right += trials.count(Verdict::kRight);
        wrong += trials.count(Verdict::kWrong);
    }
};

} // namespace

std::vector<std::string> alignment_trial_findings(const TrialResults& results) {
    Sum sum;
    WrongOnes wrong;
    for (const auto& [world, trials] : results.aligned) {
        sum.add(trials);
        wrong.add(world, trials);
    }
    std::vector<std::string> findings{
        fmt::format("{} of {} are right, and {}.", sum.right, sum.scenes, wrong_text(sum.right, sum.wrong))};
    wrong.append_to(findings);
    return findings;
}

std::vector<std::string> locating_trial_findings(const TrialResults& results) {
    std::map<std::size_t, Sum> sums; // by the number of captures in a map
    WrongOnes wrong;
    for (const auto& row : results.located) {
        sums[row.captures].add(row.trials);
        wrong.add(fmt::format("{}, map of {}", row.map, captures_text(row.captures)), row.trials);
    }
    std::vector<std::string> findings;
    for (const auto& [captures, sum] : sums) {
        findings.push_back(fmt::format("In maps of {} {} of {} views are found, and {}.", captures_text(captures),
                                       sum.right, sum.scenes, wrong_text(sum.right, sum.wrong)));
    }
    wrong.append_to(findings);
    return findings;
}

std::vector<std::string> stranger_findings(const TrialResults& results) {
    Sum sum;
    std::vector<std::string> clear;
    for (const auto& [seen, map, captures, trials] : results.strangers) {
        sum.add(trials);
        for (const Trial& trial : trials.each) {
            if (trial.verdict != Verdict::kWrong) continue;
            clear.push_back(
                fmt::format("Clear, but the view is of another world: {} in a map of the {} of {}, scene {}.", seen,
                            map, captures_text(captures), trial.seed));
        }
    }
    std::vector<std::string> findings{fmt::format("{} of {} are refused.", sum.scenes - sum.wrong, sum.scenes)};
    findings.insert(findings.end(), clear.begin(), clear.end());
    return findings;
}

void add_trials(Document& document, const TrialResults& results) {
    const robot::Noise noise;
    document.insert(
        document.end(),
        {
            Heading{2, "Reliability of alignments"},
            Paragraph{
                fmt::format("{} random scenes of each kind: in the simulator's room, its office (corridors and rooms) "
                            "and its hall, a lidar with 360 beams, a range of 12 m, {} m and {} rad noise (standard "
                            "deviations) is at two places 0.5 to 2 m apart, each in sight of the other; {} turns each; "
                            "between the captures, a door is closed or opened. Right: clear, and within {:g} cm and "
                            "{:g} degrees of the ground truth; wrong: clear, but not right. The worst errors are those "
                            "of right results, separately for position and direction.",
                            results.scenes, noise.range, noise.beam_angle, robot::kAlignedTurns, 100.0 * kRightDistance,
                            kRightDegrees)},
            alignment_trial_table(results),
            Items{alignment_trial_findings(results)},
            Heading{2, "Localization in a map"},
            Paragraph{fmt::format("A map consists of captures from several places, each in sight of an earlier one and "
                                  "at most 3 m from it, every second one with a closed door; a view from another such "
                                  "place is localized in it without an initial guess. {} turns from each place.",
                                  robot::kMappedTurns)},
            locating_table(results),
            Items{locating_trial_findings(results)},
            Paragraph{"Views of a world that is not in the map must be refused: a clear result is always wrong."},
            stranger_table(results),
            Items{stranger_findings(results)},
        });
    if (!results.picture) return;
    const auto& [file, world, captures, trial] = *results.picture;
    document.push_back(Paragraph{"Blue: the map, with discs at the places of its captures; orange: the view at its "
                                 "localized pose. The cross is its lidar."});
    document.push_back(
        Picture{fmt::format("{}/{}", kPicturesFolder, file),
                fmt::format("a view in a map of the {} of {}, scene {}: off by {:.1f} mm and {:.2f} degrees", world,
                            captures_text(captures), trial.seed, trial.error.millimetres(), trial.error.degrees())});
}

void add_trial_times(Document& document, const TrialResults& results) {
    Table table{{"scenes of", "captures", "scenes", "seconds", "ms a scene"}, {}};
    const auto add = [&](std::string kind, std::string captures, const Trials& trials) {
        const auto scenes = static_cast<double>(trials.each.size());
        table.rows.push_back({std::move(kind), std::move(captures), counted(trials.each.size()),
                              fmt::format("{:.1f}", trials.seconds),
                              fmt::format("{:.0f}", 1e3 * trials.seconds / scenes)});
    };
    for (const auto& [world, trials] : results.aligned) add("alignment, " + world, "2", trials);
    for (const auto& row : results.located) add("localization, " + row.map, counted(row.captures), row.trials);
    for (const auto& row : results.strangers) {
        add(fmt::format("{} in the {}", row.seen, row.map), counted(row.captures), row.trials);
    }
    document.push_back(Paragraph{
        fmt::format("Seconds for all scenes of a kind, including their simulation. {} threads.", worker_count())});
    document.push_back(std::move(table));
}

} // namespace scanloom::lab
