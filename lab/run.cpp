#include "lab/run.hpp"

#include "common/app/machine.hpp"
#include "common/app/standard_streams.hpp"
#include "lab/cluster_report.hpp"
#include "lab/estimated_trajectory.hpp"
#include "lab/markdown.hpp"
#include "lab/report.hpp"
#include "lab/score_report.hpp"
#include "lab/trajectory_score.hpp"
#include "robot_client/sources/carmen_log.hpp"

#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <optional>

namespace scanloom::lab {

Result<OutputDirectory> OutputDirectory::open(const std::filesystem::path& path) {
    std::error_code failed;
    std::filesystem::create_directories(path, failed);
    if (!failed) return OutputDirectory(path);
    return Error{Errc::kStoreFailed, fmt::format("{}: the directory cannot be created: {}; name another with --out",
                                                 path.string(), failed.message())};
}

Result<> OutputDirectory::write(const std::filesystem::path& file, std::string_view content) const {
    const auto path = path_ / file;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (out) return {};
    return Error{Errc::kStoreFailed,
                 fmt::format("{}: cannot be written; check the free space and the permissions", path.string())};
}

Result<> OutputDirectory::write(const std::filesystem::path& file, std::span<const std::uint8_t> content) const {
    return write(file, std::string_view(reinterpret_cast<const char*>(content.data()), content.size()));
}

namespace {

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Reports the progress of an experiment from time to time. Fine cells take most of the time: the remaining time is
/// estimated with a time per scan proportional to 1 / cell size, which nearly matches measurements.
class Progress {
public:
    Progress(Console& console, const Matrix& matrix) : console_(console), matrix_(matrix) {
        for (const double cell_size : matrix.cell_sizes) work_ += 1.0 / cell_size;
        work_ *= static_cast<double>(matrix.scans * matrix.run_count() / matrix.cell_sizes.size());
    }

    void operator()(const RunSpec& running, std::size_t runs_done, std::size_t scans_done) {
        work_done_ += 1.0 / running.cell_size;
        const double now = steady_seconds();
        const double period = std::chrono::duration<double>(console_.progress_period()).count();
        if (!begun_) begun_ = reported_ = now; // excludes preparation before the first scan
        if (now < reported_ + period) return;
        reported_ = now;
        const double elapsed = now - *begun_;
        console_.progress(fmt::format("run {} of {}: {}, {:.0f} scans a second, {} left", runs_done + 1,
                                      matrix_.run_count(), name_of(running), static_cast<double>(scans_done) / elapsed,
                                      as_clock(elapsed * (work_ - work_done_) / work_done_)));
    }

private:
    Console& console_;
    const Matrix& matrix_;
    double work_ = 0.0;
    double work_done_ = 0.0;
    std::optional<double> begun_; ///< time of the first scan
    double reported_ = 0.0;
};

/// The directories of a report.
struct ReportFiles {
    OutputDirectory directory;
    OutputDirectory pictures;

    [[nodiscard]] static Result<ReportFiles> open(const std::string& out) {
        auto directory = OutputDirectory::open(out);
        if (!directory) return directory.error();
        auto pictures = OutputDirectory::open(directory->path() / kPicturesFolder);
        if (!pictures) return pictures.error();
        return ReportFiles{std::move(*directory), std::move(*pictures)};
    }

    /// Writes both parts of a report, as Markdown and as HTML.
    [[nodiscard]] Result<> write(std::string_view report, std::string_view times) const {
        for (const auto& [name, text] : {std::pair{kReportFile, report}, {kTimesFile, times}}) {
            if (auto written = directory.write(fmt::format("{}.md", name), text); !written) return written;
            if (auto written = directory.write(fmt::format("{}.html", name), to_html(text)); !written) return written;
        }
        return {};
    }

    /// Returns the name of the report as JSON.
    [[nodiscard]] std::string report_name() const {
        return boost::json::serialize((directory.path() / kReportFile).string() + ".html");
    }
};

Result<std::string> run_experiment_of(const ExperimentOptions& options, Console& console) {
    Matrix matrix = options.quick ? quick_matrix() : full_matrix();
    matrix.seed = options.seed;
    matrix.scans = options.scans.value_or(matrix.scans);
    const auto files = ReportFiles::open(options.out);
    if (!files) return files.error();

    const double begun = steady_seconds();
    const auto keep = [&](const std::string& file, const tiles::Bytes& png) {
        return files->pictures.write(file, png);
    };
    const auto results = run_experiment(matrix, {steady_seconds, keep, Progress(console, matrix)});
    if (!results) return results.error();
    auto written = files->write(report_of(matrix, *results), times_report_of(matrix, *results, machine_description()));
    if (!written) return written.error();
    return fmt::format(R"({{"runs":{},"scans":{},"seconds":{:.3f},"report":{}}})", results->size(),
                       results->size() * matrix.scans, steady_seconds() - begun, files->report_name());
}

Result<std::string> run_landmarks_of(const LandmarkOptions& options, Console& console) {
    LandmarkPlan plan{.seed = options.seed};
    if (options.capture) {
        auto read = read_ld06_recording(*options.capture);
        if (!read) return read.error();
        plan.recorded = std::move(*read);
    }
    const auto files = ReportFiles::open(options.out);
    if (!files) return files.error();

    const double begun = steady_seconds();
    const auto keep = [&](const std::string& file, const tiles::Bytes& png) {
        return files->pictures.write(file, png);
    };
    const auto tell = [&](std::string_view doing) { console.progress(doing); };
    const auto results = run_landmark_experiment(plan, {steady_seconds, keep, tell});
    if (!results) return results.error();
    auto written = files->write(report_of(*results), times_report_of(*results, machine_description()));
    if (!written) return written.error();
    return fmt::format(R"({{"places":{},"recorded_turns":{},"seconds":{:.3f},"report":{}}})", results->places.size(),
                       results->recorded ? results->recorded->turns : 0, steady_seconds() - begun,
                       files->report_name());
}

/// Returns the CPU time of all threads of this process.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Result<std::string> run_localization_of(const LocalizationOptions& options, Console& console) {
    std::vector<RecordedLog> logs;
    for (const LogFiles& files : options.files) {
        auto log = read_recorded_log(files);
        if (!log) return log.error();
        // before the estimates, which take minutes
        if (const auto score = score_odometry(*log); !score) return prefixed(files.relations + ": ", score.error());
        logs.push_back(std::move(*log));
    }
    const auto files = ReportFiles::open(options.out);
    if (!files) return files.error();

    const double begun = steady_seconds();
    const auto keep = [&](const std::string& file, const tiles::Bytes& png) {
        return files->pictures.write(file, png);
    };
    const auto tell = [&](std::string_view doing) { console.progress(doing); };
    LocalizationResults results{.files = options.files};
    for (const RecordedLog& log : logs) {
        auto result = run_localization(log, {cpu_seconds, keep, tell});
        if (!result) return result.error();
        results.logs.push_back(std::move(*result));
    }
    auto written = files->write(report_of(results), times_report_of(results, machine_description()));
    if (!written) return written.error();
    return fmt::format(R"({{"logs":{},"seconds":{:.3f},"report":{}}})", results.logs.size(), steady_seconds() - begun,
                       files->report_name());
}

Result<> write_file(const std::string& path, std::string_view content) {
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (out) return {};
    return Error{Errc::kStoreFailed,
                 fmt::format("{}: cannot be written; check the directory, the free space and the permissions", path)};
}

Result<std::string> run_score_of(const ScoreOptions& options, Console& console) {
    const auto relations = read_relations(options.relations); // first, because reading them takes no time
    if (!relations) return relations.error();
    robot::CarmenOptions carmen;
    carmen.poses = options.poses;
    auto log = robot::CarmenLog::open(options.log, carmen, [](const robot::SkippedLine&) {});
    if (!log) return log.error();
    PerturbedSource source(*log, options.perturbation);

    const double period = std::chrono::duration<double>(console.progress_period()).count();
    double reported = steady_seconds();
    const auto show = [&, total = source.scan_count().value_or(0)](std::size_t scans) {
        if (steady_seconds() < reported + period) return;
        reported = steady_seconds();
        console.progress(fmt::format("{} of {} scans", scans, total));
    };
    auto estimated = estimate_trajectory(source, cpu_seconds, show);
    if (!estimated) return prefixed(options.log + ": ", estimated.error());
    if (options.trajectory) {
        if (auto written = write_file(*options.trajectory, tum_text(estimated->final_poses)); !written) {
            return written.error();
        }
    }

    const auto use = options.perturbation.drops_scans() ? RelationUse::kOfScans : RelationUse::kInterpolated;
    const auto final_poses = score_trajectory(estimated->final_poses, *relations, use);
    if (!final_poses) return prefixed(options.relations + ": ", final_poses.error());
    const auto first_poses = score_trajectory(estimated->first_poses, *relations, use);
    if (!first_poses) return prefixed(options.relations + ": ", first_poses.error());
    const ScoreResult result{estimated->final_poses.size(), log->skipped_lines(), estimated->cpu_seconds, *final_poses,
                             *first_poses};
    console.note(score_table(options, result));
    return score_json(options, result);
}

Result<std::string> run_cluster_of(const cluster::Plan& plan, Console& console) {
    const auto report = cluster::report_of(plan);
    console.note(cluster::tables_of(plan, report));
    return cluster::json_of(plan, report);
}

template <class Options>
ExitCode run_and_report(const Options& options, Result<std::string> (*work)(const Options&, Console&)) {
    Console console(standard_error());
    const auto result = work(options, console);
    if (!result) {
        console.note("scanloom-lab: " + result.error().message);
        return kExitFailed;
    }
    console.finish();
    fmt::print("{}\n", *result);
    return kExitDone;
}

} // namespace

ExitCode run(const ExperimentOptions& options) { return run_and_report(options, run_experiment_of); }
ExitCode run(const LandmarkOptions& options) { return run_and_report(options, run_landmarks_of); }
ExitCode run(const ScoreOptions& options) { return run_and_report(options, run_score_of); }
ExitCode run(const LocalizationOptions& options) { return run_and_report(options, run_localization_of); }
ExitCode run(const cluster::Plan& plan) { return run_and_report(plan, run_cluster_of); }

} // namespace scanloom::lab
