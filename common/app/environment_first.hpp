#pragma once

#include "common/app/config_text.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <istream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

/// A program's settings from three sources: a flag overrides the environment, which overrides the file of --config.
/// Only option parsers include this header.
namespace scanloom {

/// Returns the name of the variable for an option: SCANLOOM_CELL_SIZE for cell-size.
[[nodiscard]] inline std::string environment_name(std::string_view option) {
    std::string name = "SCANLOOM_";
    for (const char c : option) name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return name;
}

/// Reads TOML and removes the settings that the environment also has: CLI11 alone would let the file override them.
class EnvironmentFirstToml final : public CLI::ConfigTOML {
public:
    /// @param app  must outlive this object; error messages name its configuration file
    explicit EnvironmentFirstToml(const CLI::App& app) : app_(app) {
        comment('\n'); // none: comments are removed before CLI11 reads a line
    }

    /// Errors: throws CLI::ConfigError if the file is not valid TOML.
    [[nodiscard]] std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
        const auto file = read_config_text(input);
        if (!file) throw CLI::ConfigError(fmt::format("{}: {}", file_name(), file.error().message));
        const auto text = one_line_a_setting(*file);
        if (!text) throw CLI::ConfigError(fmt::format("{}:{}", file_name(), text.error().message));
        std::istringstream lines(*text);
        auto settings = CLI::ConfigTOML::from_config(lines);
        std::erase_if(settings, [](const CLI::ConfigItem& item) {
            return std::getenv(environment_name(item.name).c_str()) != nullptr;
        });
        return settings;
    }

private:
    [[nodiscard]] std::string file_name() const { return app_.get_config_ptr()->as<std::string>(); }

    const CLI::App& app_;
};

/// Rejects empty values: a script's variable that was never set must not switch off a setting.
[[nodiscard]] inline std::string check_not_empty(const std::string& text) {
    return text.empty() ? "it is given but empty; give it a value, or leave it out" : "";
}

/// Throws CLI::ValidationError if the option's environment variable is empty. CLI11 ignores empty variables.
inline void refuse_empty_setting(const CLI::Option& option) {
    const auto name = environment_name(option.get_lnames().front());
    const char* value = std::getenv(name.c_str());
    if (value != nullptr && *value == '\0') throw CLI::ValidationError(name, check_not_empty(value));
}

/// Makes `app` read settings from the environment and from the file of --config.
///
/// Call it after all options and subcommands are added. app.parse() then rejects unknown settings in the file.
/// Errors: throws CLI::ParseError if SCANLOOM_CONFIG names a missing file or a setting in the environment is empty.
inline void read_settings_from_environment_and_file(CLI::App& app) {
    const auto name_options = [](CLI::App& level) {
        for (CLI::Option* option : level.get_options()) {
            if (!option->get_lnames().empty() && option->get_configurable()) {
                option->envname(environment_name(option->get_lnames().front()));
                option->check(&check_not_empty);
                refuse_empty_setting(*option);
            }
        }
    };
    name_options(app);
    for (CLI::App* source : app.get_subcommands({})) name_options(*source);
    app.config_formatter(std::make_shared<EnvironmentFirstToml>(app));
    app.allow_config_extras(CLI::config_extras_mode::error);

    // CLI11 reads the file before the environment, so SCANLOOM_CONFIG is the default value of --config.
    const char* file = std::getenv("SCANLOOM_CONFIG");
    const std::string default_file = file != nullptr ? file : "";
    if (!default_file.empty() && !std::filesystem::exists(default_file)) throw CLI::FileError::Missing(default_file);
    app.set_config("--config", default_file, "TOML file with settings (Env:SCANLOOM_CONFIG)");
}

} // namespace scanloom
