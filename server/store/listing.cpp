#include "server/store/listing.hpp"

#include "server/store/advice.hpp"
#include "server/store/failure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

/// Files that do not show whether there is a store. *.dbtmp is left by checks of whether the disk can be written.
bool is_neutral(const std::string& name) {
    return name == kLockFile || name == "lost+found" || name == "LOCK" || name.ends_with(".dbtmp");
}

/// Files that RocksDB creates before CURRENT, or in addition to it.
bool is_trace(const std::string& name) {
    return name == "IDENTITY" || name.starts_with("LOG") || name.starts_with("MANIFEST-") ||
           name.starts_with("OPTIONS-");
}

void note(Listing& listing, const std::string& name) {
    if (name == "CURRENT")
        listing.has_current = true;
    else if (name == kNewFile)
        listing.is_new = true;
    else if (name == kUnfinishedFile)
        listing.is_unfinished = true;
    else if (name.ends_with(".sst"))
        listing.has_tables = true;
    else if (name.ends_with(".log"))
        listing.has_write_ahead_logs = true;
    else if (is_neutral(name))
        return;
    else if (is_trace(name))
        listing.trace = name;
    else
        listing.foreign = name;
}

} // namespace

Result<Listing> listing_of(const fs::path& directory) {
    Listing listing;
    std::error_code problem;
    fs::directory_iterator file(directory, problem);
    for (; !problem && file != fs::directory_iterator(); file.increment(problem)) {
        note(listing, file->path().filename().native());
    }
    if (problem) return failure("cannot list the store {}: {}", directory.native(), problem.message());
    return listing;
}

bool is_store_file(const std::string& name) {
    Listing listing;
    note(listing, name);
    return listing.foreign.empty() && name != "lost+found";
}

std::vector<fs::path> regular_files(const fs::path& directory, std::string_view extension) {
    std::vector<fs::path> found;
    std::error_code none;
    for (fs::directory_iterator file(directory, none); !none && file != fs::directory_iterator();
         file.increment(none)) {
        if (!extension.empty() && file->path().extension() != extension) continue;
        if (file->is_regular_file(none)) found.push_back(file->path());
    }
    std::ranges::sort(found);
    return found;
}

Result<> check_listing(const fs::path& directory, const Listing& listing) {
    if (listing.is_unfinished) {
        return failure("the store {} is unfinished: the --repair that makes it has not come to its end; let it, or run "
                       "it once more",
                       directory.native());
    }
    if (!listing.has_current && (listing.has_tables || listing.has_write_ahead_logs)) {
        return failure("the store {} is damaged: its file CURRENT is missing; {}", directory.native(), kBringBack);
    }
    if (!listing.has_current && !listing.foreign.empty()) {
        return Error{Errc::kNotFound, fmt::format("the directory {} holds other files ({}) and no store; name a "
                                                  "directory of its own",
                                                  directory.native(), listing.foreign)};
    }
    if (!listing.has_current && !listing.trace.empty() && !listing.is_new) {
        return failure(
            "the store {} has lost all its entries: of its files only such as {} are left; restore it from a "
            "backup (--restore) into another directory, or delete what is left to begin with an empty one",
            directory.native(), listing.trace);
    }
    const bool has_been_open = listing.has_tables || (listing.has_current && !listing.is_new);
    if (has_been_open && !listing.has_write_ahead_logs) {
        return failure("the store {} is damaged: its write-ahead log (*.log) is missing; {}", directory.native(),
                       kBringBack);
    }
    return {};
}

} // namespace scanloom::store
