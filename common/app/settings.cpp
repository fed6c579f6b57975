#include "common/app/settings.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <istream>
#include <memory>
#include <optional>
#include <sstream>
#include <vector>

namespace scanloom {
namespace {

Error fault(std::size_t line, std::string_view what) { return {Errc::kMalformed, fmt::format("{}: {}", line, what)}; }

/// Returns the position after the string that begins at `begin`; nullopt if its line ends first.
std::optional<std::size_t> end_of_string(std::string_view text, std::size_t begin) {
    const char quote = text[begin];
    for (std::size_t at = begin + 1; at < text.size() && text[at] != '\n'; ++at) {
        if (text[at] == quote) return at + 1;
        if (text[at] == '\\' && quote == '"') ++at;
    }
    return std::nullopt;
}

/// Returns whether the text at `at` may follow a string or an array.
bool is_separated(std::string_view text, std::size_t at) {
    const auto next = text.find_first_not_of(" \t\r", at);
    return next == std::string_view::npos || std::string_view("\n#,]=").find(text[next]) != std::string_view::npos;
}

} // namespace

Result<std::string> one_line_a_setting(std::string_view toml) {
    std::string settings;
    std::size_t line = 1;
    std::vector<std::size_t> open; // line numbers of the brackets that are not closed yet
    for (std::size_t at = 0; at < toml.size();) {
        const char c = toml[at];
        std::size_t end = at + 1;
        if (c == '#') {
            at = std::min(toml.find('\n', at), toml.size());
            continue;
        }
        if (c == '"' || c == '\'') {
            const auto closed = end_of_string(toml, at);
            if (!closed) return fault(line, fmt::format("a string is not closed; end it with {}", c));
            end = *closed;
        }
        if (c == '[') open.push_back(line);
        if (c == ']') {
            if (open.empty()) return fault(line, "there is a ] without a [ before it; remove it");
            open.pop_back();
        }
        if ((c == '"' || c == '\'' || c == ']') && !is_separated(toml, end)) {
            return fault(line, fmt::format("there is more behind the {}; put one value, or a comma between two", c));
        }
        if (c == '\n') ++line;
        settings += c == '\n' && !open.empty() ? " " : toml.substr(at, end - at);
        at = end;
    }
    if (!open.empty()) return fault(open.front(), "a [ is not closed; end it with ]");
    return settings;
}

Result<std::string> read_config_text(std::istream& input) {
    std::string text(kConfigBytesMax + 1, '\0');
    input.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(input.gcount()));
    if (text.size() <= kConfigBytesMax) return text;
    return Error{Errc::kFull, fmt::format("it has more than {} bytes; name a file of settings", kConfigBytesMax)};
}

std::string check_not_empty(const std::string& text) {
    return text.empty() ? "it is given but empty; give it a value, or leave it out" : "";
}

namespace {

/// Returns the name of the variable for an option: SCANLOOM_CELL_SIZE for cell-size.
std::string environment_name(std::string_view option) {
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
        auto settings = lifted(CLI::ConfigTOML::from_config(lines));
        std::erase_if(settings, [](const CLI::ConfigItem& item) {
            return std::getenv(environment_name(item.name).c_str()) != nullptr;
        });
        return settings;
    }

private:
    /// Moves settings that stand in the section of the subcommand but are options of the program to the front, where
    /// they come before those outside of sections. CLI11 accepts such options on the command line only.
    [[nodiscard]] std::vector<CLI::ConfigItem> lifted(std::vector<CLI::ConfigItem> settings) const {
        const auto is_of_program = [&](const CLI::ConfigItem& item) {
            if (item.parents.size() != 1 || app_.get_option_no_throw("--" + item.name) == nullptr) return false;
            const auto sections =
                app_.get_subcommands([&](const CLI::App* source) { return source->check_name(item.parents.front()); });
            return !sections.empty() && sections.front()->get_option_no_throw("--" + item.name) == nullptr;
        };
        const auto others = std::stable_partition(settings.begin(), settings.end(), is_of_program);
        std::vector<CLI::ConfigItem> sorted;
        for (auto item = settings.begin(); item != settings.end(); ++item) {
            const bool is_lifted = item < others;
            if (is_lifted && !app_.got_subcommand(item->parents.front())) continue; // of another source
            if (is_lifted) item->parents.clear();
            sorted.push_back(std::move(*item));
        }
        return sorted;
    }

    [[nodiscard]] std::string file_name() const { return app_.get_config_ptr()->as<std::string>(); }

    const CLI::App& app_;
};

/// Lets the options of `level` be set by the environment.
/// Errors: throws CLI::ValidationError if an option's variable is empty, which CLI11 would ignore.
void name_variables(CLI::App& level) {
    for (CLI::Option* option : level.get_options()) {
        if (option->get_lnames().empty() || !option->get_configurable()) continue;
        const auto name = environment_name(option->get_lnames().front());
        const char* value = std::getenv(name.c_str());
        if (value != nullptr && *value == '\0') throw CLI::ValidationError(name, check_not_empty(value));
        option->envname(name);
        // transform() puts it before the other checks.
        option->transform(CLI::Validator([](std::string& text) { return check_not_empty(text); }, ""));
    }
}

} // namespace

void read_settings_from_environment_and_file(CLI::App& app) {
    name_variables(app);
    for (CLI::App* source : app.get_subcommands({})) name_variables(*source);
    app.config_formatter(std::make_shared<EnvironmentFirstToml>(app));
    app.allow_config_extras(CLI::config_extras_mode::error);

    // CLI11 reads the file before the environment, so SCANLOOM_CONFIG is the default value of --config.
    const char* file = std::getenv("SCANLOOM_CONFIG");
    const std::string default_file = file != nullptr ? file : "";
    if (!default_file.empty() && !std::filesystem::exists(default_file)) throw CLI::FileError::Missing(default_file);
    app.set_config("--config", default_file, "TOML file with settings (Env:SCANLOOM_CONFIG)");
}

Result<std::string> read_token(const std::string& path) {
    std::string token;
    if (path.empty()) return token;
    std::ifstream file(path);
    std::getline(file, token);
    if (token.ends_with('\r')) token.pop_back();
    if (!token.empty()) return token;
    return Error{Errc::kNotFound, fmt::format("{}: there is no token; write it to the first line of this file", path)};
}

} // namespace scanloom
