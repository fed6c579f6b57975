#include "server/sessions/repair.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"
#include "server/sessions/log_reconstruction.hpp"
#include "server/sessions/log_writer.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <future>
#include <set>
#include <utility>
#include <vector>

namespace scanloom::sessions {
namespace {

std::string with_id(std::string name, store::SessionId id) {
    const auto ending = fmt::format("-{}", id);
    name.resize(std::min(name.size(), kNameBytesMax - ending.size()));
    return name + ending;
}

/// Returns the name in a record; nullopt if it is lost or cannot be decoded.
std::optional<std::string> name_in(const std::optional<std::string>& record) {
    if (!record) return std::nullopt;
    const auto decoded = wire::decode_session(*record);
    if (!decoded) return std::nullopt;
    return decoded->name;
}

/// The file of entries that cannot be applied. Created with the first entry.
class AsideFile {
public:
    explicit AsideFile(std::filesystem::path path) : path_(std::move(path)) {}

    Result<> add(std::string_view entry) {
        const auto decoded = wire::plain_entry(entry);
        const auto plain = decoded ? std::string_view(*decoded) : entry; // undecodable entries are copied
        if (count_++ == 0) {
            std::error_code problem;
            std::filesystem::create_directories(path_.parent_path(), problem);
            file_.open(path_, std::ios::binary);
        }
        std::array<unsigned char, 4> length{};
        boost::endian::store_big_u32(length.data(), static_cast<std::uint32_t>(plain.size()));
        file_.write(reinterpret_cast<const char*>(length.data()), length.size());
        file_.write(plain.data(), static_cast<std::streamsize>(plain.size()));
        return is_well();
    }

    Result<> close() {
        if (count_ == 0) return {};
        file_.close();
        return is_well();
    }

    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

private:
    [[nodiscard]] Result<> is_well() const {
        if (file_) return {};
        return Error{Errc::kStoreFailed, fmt::format("cannot write {}; make room on its disk", path_.native())};
    }

    const std::filesystem::path path_;
    std::ofstream file_;
    std::uint64_t count_ = 0;
};

/// Returns the record for the new store, without the number of imported patches. Some of them may be lost, and a start
/// removes a session that has fewer entries than its import.
std::optional<std::string> record_to_keep(const std::string& bytes, const std::string& name) {
    auto record = wire::decode_session(bytes);
    if (!record) return std::nullopt;
    record->entries_at_creation = 0;
    record->replaces = 0; // it may be lost, or kept under another name
    record->name = name;
    return wire::encode_session(*record);
}

/// Creates the session in the new store. @return nullopt if its record is lost or cannot be decoded
Result<std::optional<store::SessionId>> target_of(const std::optional<std::string>& record, const std::string& name,
                                                  store::ScanLog& to) {
    const auto kept = record ? record_to_keep(*record, name) : std::nullopt;
    if (!kept) return std::optional<store::SessionId>();
    const auto created = to.create_session(*kept);
    if (!created) return created.error();
    return std::optional(*created);
}

} // namespace

std::map<store::SessionId, std::string>
repaired_names(const std::map<store::SessionId, std::optional<std::string>>& records) {
    std::map<store::SessionId, std::string> names;
    std::set<std::string> taken;
    const auto give = [&](store::SessionId id, std::string name) {
        while (!taken.insert(name).second) name = with_id(std::move(name), id);
        names.emplace(id, std::move(name));
    };
    for (auto session = records.rbegin(); session != records.rend(); ++session) {
        const auto name = name_in(session->second);
        if (name && !taken.contains(*name)) give(session->first, *name);
    }
    for (const auto& [id, record] : records) { // sessions whose name is taken or lost
        if (!names.contains(id)) give(id, with_id(name_in(record).value_or("session"), id));
    }
    return names;
}

Result<RepairedSession> repair_session(const store::DamagedStore& from, store::SessionId id,
                                       const std::optional<std::string>& record, const std::string& name,
                                       store::ScanLog& to, const std::filesystem::path& aside) {
    const auto target = target_of(record, name, to);
    if (!target) return target.error();
    RepairedSession repaired{.name = name, .aside = aside / (name + ".scanlog")};
    LogReconstruction reconstruction;
    LogWriter kept(to, target->value_or(0));
    AsideFile set_aside(repaired.aside);
    const auto original = record ? wire::decode_session(*record) : Result<wire::SessionRecord>(wire::SessionRecord());
    const Revision at_creation = original ? original->entries_at_creation : 0;
    repaired.lost_at_creation = at_creation;
    const auto read = from.read(id, [&](Revision revision, std::string_view bytes) -> Result<> {
        auto entry = wire::decode_entry(bytes);
        if (entry && revision <= at_creation) --repaired.lost_at_creation;
        if (!entry || !*target) return set_aside.add(bytes);
        const auto entries = reconstruction.add(revision, std::move(*entry));
        if (entries.empty()) return set_aside.add(bytes);
        for (const auto& one : entries) {
            if (auto added = kept.add(one); !added) return added;
        }
        return {};
    });
    if (!read) return read.error();
    if (auto written = kept.write(); !written) return written.error();
    if (auto closed = set_aside.close(); !closed) return closed.error();
    repaired.kept = kept.end() - reconstruction.empty_scans();
    repaired.empty_scans = reconstruction.empty_scans();
    repaired.missing = reconstruction.missing();
    repaired.set_aside = set_aside.count();
    if (repaired.set_aside == 0) repaired.aside.clear();
    return repaired;
}

} // namespace scanloom::sessions
