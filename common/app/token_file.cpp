#include "common/app/token_file.hpp"

#include <fmt/format.h>

#include <fstream>

namespace scanloom {

Result<std::string> read_token(const std::string& path) {
    std::string token;
    if (path.empty()) return token;
    std::ifstream file(path);
    std::getline(file, token);
    if (token.ends_with('\r')) token.pop_back();
    if (!token.empty()) return token;
    return Error{Errc::kNotFound, fmt::format("{}: no token to be read; the first line is it", path)};
}

} // namespace scanloom
