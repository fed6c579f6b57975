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
    "Left in blue the first capture, right in orange the second, each over the other in grey. Discs are landmarks that "
    "match, joined by dashed lines; red rings are landmarks that match none. The cross is the lidar.";

Items conditions(const LandmarkResults& results) {
    std::string places;
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        const Pose2& place = results.places[n].place;
        places += fmt::format("{}{} at ({}, {})", n == 0 ? "" : ", ", place_name(n), place.x, place.y);
    }
    const robot::Noise noise;
    return {{
        "The room is the simulator's, 10 x 10 m with furniture, and has a doorway of 1 m in its eastern wall with a "
        "lobby behind it. The door closes the doorway, or stands into the room at a right angle to the wall.",
        fmt::format("A lidar of 360 beams all round and 12 m stands still at one of three places: {} m.", places),
        fmt::format("A capture is {} turns. Ranges have a noise of {} m, beam angles of {} rad (standard deviations). "
                    "Seed: {}.",
                    kTurns, noise.range, noise.beam_angle, results.seed),
        "Landmarks, their eps and the tolerance of matching are the defaults of the server: eps by the cloud, 5 "
        "points, "
        "0.25 m. Clouds are compared in the map frame, by the true poses; only the alignments know nothing of these.",
    }};
}

Items landmark_definitions() {
    return {{
        "matched: landmarks of both captures that are each other's nearest and within the tolerance. only first, only "
        "second: the others of each capture.",
        "persistence: matched of the first capture's landmarks. stability: of the matched, those within half the "
        "tolerance. mean, sd: of the distances of matched landmarks, and their standard deviation.",
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
    document.push_back(Paragraph{
        "The first capture is with the door closed, the second with it opened; or, for comparison, still closed."});
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
                "the frames that it sends, a batch of Protocol Buffers for each turn. The server's are reckoned from "
                "the sizes of what it holds while it clusters: of each point 24 bytes (the point, which distinct one "
                "it is, its cluster), of each distinct point 52, of each cell of the grid over these 56; spare room of "
                "vectors and search trees of crowded cells are not in it.",
                place_name(0))},
            readings_table(results),
            Heading{2, "Median filter"},
            Paragraph{fmt::format(
                "Over each turn of the capture of place {}, door closed. RMSE: from the unfiltered points. Noise "
                "reduction: how much less neighbouring points bend, along each axis. Errors: medians of how far "
                "readings are from those without noise, for beams within three beams of a corner or an edge, and for "
                "the others.",
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
                        Paragraph{"Where the second capture was taken from, as seen from the first, without any guess; "
                                  "off by: from the truth. Explained and contradicted are shares of the second "
                                  "capture's surface."},
                        alignment_table(results),
                        Items{alignment_findings(results)},
                        Heading{2, "Alignment by landmarks alone"},
                        Paragraph{fmt::format(
                            "The transform of the landmarks that were matched above, in the map frame and by the true "
                            "poses, beside that of the surfaces, which are told no pose; of a place with itself, and "
                            "of one place with the next. Agreeing are the pairs that the transform brings within half "
                            "the tolerance, {} m, of each other; rms: of these. Off by: where the second lidar would "
                            "be.",
                            kAgreeingDistance)},
                        ways_table(results),
                        Items{ways_findings(results)},
                    });
}

void add_recording(Document& document, const RecordedResult& recorded) {
    document.insert(
        document.end(),
        {
            Heading{2, "A recording"},
            Paragraph{fmt::format(
                "{}, the bytes that a real LD06 sent in a room, which stood still: {}. The file is no part of the "
                "project. The first half of the turns is compared with the second.",
                recorded.name, recorded.remarks)},
            recording_table(recorded),
            halves_table(recorded),
            Paragraph{recording_finding(recorded)},
            Paragraph{"The halves, aligned by their landmarks and by their surfaces; off by: from standing still."},
            halves_ways_table(recorded),
            Paragraph{kPictureKey},
            Picture{fmt::format("{}/{}", kPicturesFolder, recorded.halves.picture),
                    fmt::format("first and second half of {}, recorded from a real LD06", recorded.name)},
        });
}

} // namespace

Document landmark_report_of(const LandmarkResults& results) {
    Document document{
        Heading{1, "Landmarks of a standing lidar"},
        Paragraph{"What the server finds in the captures of a lidar that stands still: its landmarks, how they persist "
                  "when a door is moved, how they depend on tolerance, number of readings and filter, how captures "
                  "of different places are aligned, and how views are found in maps. Made by"},
        Code{fmt::format("./scanloom build && build/bin/scanloom-lab landmarks --out docs/landmarks --seed {}{}{}",
                         results.seed, scenes_option(results),
                         results.recorded ? " --capture " + results.recorded->name : "")},
        Paragraph{"The same seed gives the same bytes. How long it took is in a file of its own, because it differs "
                  "each time:"},
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
