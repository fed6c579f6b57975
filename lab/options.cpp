#include "lab/options.hpp"

#include "common/app/environment_first.hpp"
#include "common/app/option_checks.hpp"
#include "common/app/parse_failure.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace scanloom::lab {
namespace {

constexpr const char* kAbout =
    "Measures how good and how fast the maps are, in simulated worlds that are known exactly.\n"
    "Exits 0 when done, 1 when something failed, 2 when it was called wrongly.";
constexpr const char* kFooter =
    "Every option may also stand in the file of --config (TOML, in a section of its command) or in the environment\n"
    "(--seed as SCANLOOM_SEED). A flag beats the environment, which beats the file.";

CLI::App* add_experiment(CLI::App& app, ExperimentOptions& options) {
    auto* experiment = app.add_subcommand(
        "experiment", "The reference experiments: scenes, cell sizes, ray models, noise and starts, as a report");
    experiment->add_option("--out", options.out,
                           "Directory for report.md, report.html, times.md, times.html and pictures/; made if it does "
                           "not exist, what is there is overwritten");
    experiment->add_option("--seed", options.seed, "Of the noise; the same seed gives the same report, times excepted")
        ->check(check_whole_number_from(0))
        ->capture_default_str();
    experiment
        ->add_option("--scans", options.scans, "Scans of each run, 10 to 100000; default: 1500, once around the room")
        ->check(check_within(10, 100'000))
        ->check(check_whole_number_from(1));
    experiment->add_flag("--quick", options.quick,
                         "Coarse cells, two kinds of noise and one start: seconds, not minutes");
    return experiment;
}

} // namespace

std::variant<ExperimentOptions, Leave> parse_options(int argc, const char* const* argv) {
    ExperimentOptions experiment_options;
    CLI::App app(kAbout, "scanloom-lab");
    app.footer(kFooter);
    app.set_version_flag("--version", fmt::format("scanloom-lab {}", kVersion));
    add_experiment(app, experiment_options);
    app.require_subcommand(1);
    try {
        read_settings_from_environment_and_file(app);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason, "say what to do: experiment");
    }
    // not required() by the parser, which would ask for it in words of its own
    if (experiment_options.out.empty()) return usage_error(app, "experiment: name a directory with --out");
    return experiment_options;
}

} // namespace scanloom::lab
