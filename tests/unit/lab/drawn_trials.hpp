#pragma once

#include "lab/alignment_trials.hpp"

namespace scanloom::lab {

inline Trials drawn_trials(std::vector<Trial> trials) { return {.each = std::move(trials), .seconds = 1.5}; }

/// Returns two alignments in a room, views in maps of the office (two are wrong), three views of another world (one
/// clear), and a picture.
inline TrialResults drawn_trial_results() {
    const Trial right{701, Verdict::kRight, {}, {0.0042, 0.002}};
    return {.scenes = 2,
            .aligned = {{"room", drawn_trials({right, {702, Verdict::kAmbiguous, {}, {3.0, 1.0}}})}},
            .located = {{"office", "office", 1, drawn_trials({{701, Verdict::kUndetermined, {}, {}}})},
                        {"office", "office", 4,
                         drawn_trials({right,
                                       {702, Verdict::kWrong, {}, {0.0301, 0.1}},
                                       {703, Verdict::kWrong, {}, {2.5, 3.0}, 0.8, 0.3}})}},
            .strangers = {{"room", "office", 4,
                           drawn_trials({{701, Verdict::kUndetermined, {}, {}},
                                         {702, Verdict::kAmbiguous, {}, {}},
                                         {703, Verdict::kWrong, {}, {}}})}},
            .picture = LocatedPicture{"l.png", "office", 4, right}};
}

} // namespace scanloom::lab
