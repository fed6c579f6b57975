#include "lab/landmark_report.hpp"

#include "lab/door_room.hpp"
#include "lab/landmark_findings.hpp"
#include "lab/landmark_tables.hpp"
#include "lab/report.hpp"
#include "lab/trial_report.hpp"

#include <fmt/format.h>

namespace scanloom::lab {
namespace {

constexpr const char* kPictureKey =
    "Left, in blue: the first capture; right, in orange: the second; each over the other one in grey. Discs are "
    "matched landmarks, joined by dashed lines; red rings are unmatched landmarks. The cross is the lidar.";

Items conditions(const LandmarkResults& results) {
    std::string places;
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        const Pose2& place = results.places[n].place;
        places += fmt::format("{}{} at ({}, {})", n == 0 ? "" : ", ", place_name(n), place.x, place.y);
    }
    const robot::Noise noise;
    return {{
        "The room is the simulator's, 10 x 10 m with furniture, and has a doorway of 1 m in its eastern wall with a "
        "lobby behind it. The door is closed, or opens into the room at a right angle to the wall.",
        fmt::format(
            "A stationary lidar with 360 beams over 360 degrees and a range of 12 m is at one of three places: {} m.",
            places),
        fmt::format("A capture is {} turns. Ranges have a noise of {} m, beam angles of {} rad (standard deviations). "
                    "Seed: {}.",
                    kTurns, noise.range, noise.beam_angle, results.seed),
        "Landmarks, their eps and the tolerance of matching are the defaults of the server: eps by the cloud, 5 "
        "points, 0.25 m. Clouds are compared in the map frame, by the true poses; only the alignments do not use them.",
    }};
}

Items landmark_definitions() {
    return {{
        "matched: landmarks of both captures that are each other's nearest and within the tolerance. only first, only "
        "second: the others of each capture.",
        "persistence: the matched share of the first capture's landmarks. stability: the share of the matched ones "
        "that are within half the tolerance. mean, sd: mean and standard deviation of the distances of matched "
        "landmarks.",
        "continuity: the mean of a cluster's linearity, evenness of spacing and fill, here over the landmarks of both "
        "captures.",
    }};
}

/// Returns the option --scenes as given, or "" for the default.
std::string scenes_option(const LandmarkResults& results) {
    const std::size_t scenes = results.trials ? results.trials->scenes : 0;
    return scenes == kScenes ? "" : fmt::format(" --scenes {}", scenes);
}

void add_doors(Document& document, const LandmarkResults& results) {
    document.push_back(Heading{2, "A door, closed and open"});
    document.push_back(
        Paragraph{"The first capture has the door closed, the second has it open or, for comparison, still closed."});
    document.push_back(door_table(results));
    document.push_back(Items{door_findings(results)});
    document.push_back(Paragraph{kPictureKey});
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        document.push_back(Picture{fmt::format("{}/{}", kPicturesFolder, results.places[n].door.picture),
                                   fmt::format("place {}: door closed, door open", place_name(n))});
    }
}

void add_sweeps(Document& document, const LandmarkResults& results) {
    document.insert(
        document.end(),
        {
            Heading{2, "Tolerance"},
            Paragraph{"Door closed and opened; the matches of the three places together."},
            tolerance_table(results),
            Paragraph{tolerance_finding(results)},
            Heading{2, "Number of readings"},
            Paragraph{fmt::format(
                "A reading is a turn of the lidar, a scan of 360 beams; place {}, door closed. The robot's bytes are "
                "the frames that it sends, a batch of Protocol Buffers for each turn. The server's bytes are computed "
                "from its data during clustering: 24 bytes for each point (the point, the index of its distinct point, "
                "its cluster), 52 for each distinct point, 56 for each cell of the grid over these; spare capacity of "
                "vectors and search trees of crowded cells are not included.",
                place_name(0))},
            readings_table(results),
            Heading{2, "Median filter"},
            Paragraph{fmt::format("For each turn of the capture of place {}, door closed. RMSE: relative to the "
                                  "unfiltered points. Noise reduction: the decrease of the bend between neighbouring "
                                  "points, along each axis. Errors: median distances between readings with and without "
                                  "noise, for beams within three beams of a corner or an edge, and for the others.",
                                  place_name(0))},
            window_table(results),
            Paragraph{window_finding(results.windows)},
        });
}

void add_neighbours(Document& document, const LandmarkResults& results) {
    document.insert(document.end(),
                    {
                        Heading{2, "From one place to the next"},
                        Paragraph{"The same figures for captures of different places, the first with the door closed."},
                        neighbour_table(results),
                        Heading{2, "Alignment"},
                        Paragraph{"The pose of the second capture relative to the first, without an initial guess; off "
                                  "by: difference from the ground truth. Inlier and outlier ratio: of the "
                                  "second capture's surface."},
                        alignment_table(results),
                        Items{alignment_findings(results)},
                        Heading{2, "Alignment by landmarks alone"},
                        Paragraph{fmt::format(
                            "The transform of the landmarks that were matched above, in the map frame and by the true "
                            "poses, next to that of the surfaces, which use no pose; for one place, and from one place "
                            "to the next. Agreeing: pairs that the transform brings within half the tolerance, {} m; "
                            "rms: their root mean square. Off by: where the second lidar would be.",
                            kAgreeingDistance)},
                        methods_table(results),
                        Items{method_findings(results)},
                    });
}

void add_recording(Document& document, const RecordedResult& recorded) {
    document.insert(
        document.end(),
        {
            Heading{2, "A recording"},
            Paragraph{fmt::format("{}, bytes of a real, stationary LD06 in a room: {}. The file is not part of the "
                                  "project. The first half of the turns is compared with the second.",
                                  recorded.name, recorded.remarks)},
            recording_table(recorded),
            halves_table(recorded),
            Paragraph{recording_finding(recorded)},
            Paragraph{
                "The halves, aligned by their landmarks and by their surfaces; off by: difference from no motion."},
            halves_methods_table(recorded),
            Paragraph{kPictureKey},
            Picture{fmt::format("{}/{}", kPicturesFolder, recorded.halves.picture),
                    fmt::format("first and second half of {}, recorded from a real LD06", recorded.name)},
        });
}

} // namespace

Document landmark_report_of(const LandmarkResults& results) {
    Document document{
        Heading{1, "Landmarks of a stationary lidar"},
        Paragraph{"The server's results for captures of a stationary lidar: landmarks, their persistence when a door "
                  "is moved, their dependence on tolerance, number of readings and filter, alignment of captures of "
                  "different places, and localization of views in maps. Made by"},
        Code{fmt::format("./scanloom build && build/bin/scanloom-lab landmarks --out docs/landmarks --seed {}{}{}",
                         results.seed, scenes_option(results),
                         results.recorded ? " --capture " + results.recorded->name : "")},
        Paragraph{
            "The same seed gives the same bytes. The durations are in a separate file, because they differ each time:"},
        Link{"Times", kTimesFile},
        Heading{2, "Conditions"},
        conditions(results),
        Heading{2, "What is measured"},
        landmark_definitions(),
    };
    add_doors(document, results);
    add_neighbours(document, results);
    if (results.trials) add_trials(document, *results.trials);
    add_sweeps(document, results);
    if (results.recorded) add_recording(document, *results.recorded);
    return document;
}

Document landmark_times_report_of(const LandmarkResults& results, std::string_view machine) {
    Document document{
        Heading{1, "Times of the landmark experiment"},
        Paragraph{fmt::format("Milliseconds to find the landmarks of a capture, the adaptive eps included: the median "
                              "of {} times. One thread. Measured on: {}.",
                              kTimings, machine)},
        Link{"The report", kReportFile},
        readings_times_table(results),
    };
    if (results.trials) add_trial_times(document, *results.trials);
    return document;
}

} // namespace scanloom::lab
