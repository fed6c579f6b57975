#include "robot_client/recordings/rosbag2.hpp"

#include "robot_client/recordings/packed_message.hpp"
#include "robot_client/recordings/recording_lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <system_error>
#include <unordered_map>

#include <sqlite3.h>

namespace scanloom::robot {
namespace {

constexpr std::uint64_t kDamagesMax = 10'000; // places of a file that are skipped

struct CloseDatabase {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;

struct FinalizeStatement {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

/// @return null if the database is damaged, or has no such table or column
Statement prepare(sqlite3& database, const std::string& sql) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(&database, sql.c_str(), static_cast<int>(sql.size()), &statement, nullptr);
    return Statement(statement);
}

std::string text_of(sqlite3_stmt& row, int column) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(&row, column));
    return text == nullptr ? std::string()
                           : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(&row, column)));
}

std::set<std::string> columns_of(sqlite3& database, const std::string& table) {
    std::set<std::string> columns;
    const Statement statement = prepare(database, "SELECT name FROM pragma_table_info('" + table + "')");
    while (statement && sqlite3_step(statement.get()) == SQLITE_ROW) columns.insert(text_of(*statement, 0));
    return columns;
}

/// Returns the path as a URI of SQLite.
std::string uri_of(const std::filesystem::path& path, bool is_immutable) {
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(path).string()) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                              c == '.' || c == '-' || c == '_';
        uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return uri + (is_immutable ? "?mode=ro&immutable=1" : "?mode=ro");
}

bool can_be_read(sqlite3& database) {
    const Statement statement = prepare(database, "SELECT count(*) FROM sqlite_master");
    return statement && sqlite3_step(statement.get()) == SQLITE_ROW;
}

/// @return null if it cannot be opened
Database open_database(const std::filesystem::path& path, bool is_immutable) {
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(uri_of(path, is_immutable).c_str(), &opened,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    Database database(opened);
    if (result != SQLITE_OK) return nullptr;
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(kRecordedBytesMax));
    // A view or trigger in a file of others could compute without end.
    sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    // Without writable_schema, SQLite reads nothing of a truncated file. The file is read-only all the same.
    sqlite3_exec(opened, "PRAGMA writable_schema=ON; PRAGMA cell_size_check=ON;", nullptr, nullptr, nullptr);
    return can_be_read(*opened) ? std::move(database) : nullptr;
}

class Rosbag2Recording final : public Recording {
public:
    Rosbag2Recording(Database database, std::uint64_t size, bool lacks_wal)
        : database_(std::move(database)), size_(size) {
        if (lacks_wal) losses_.add(size, "the messages of the -wal file next to the database, which cannot be read");
    }

    /// @return false if it is no database of rosbag2
    [[nodiscard]] bool prepare_reading() {
        const auto of_messages = columns_of(*database_, "messages");
        const auto of_topics = columns_of(*database_, "topics");
        const auto has = [](const std::set<std::string>& columns, std::initializer_list<const char*> names) {
            return std::ranges::all_of(names, [&](const char* name) { return columns.contains(name); });
        };
        if (!has(of_messages, {"topic_id", "timestamp", "data"}) || !has(of_topics, {"id", "name", "type"}))
            return false;
        const bool has_format = of_topics.contains("serialization_format");
        topics_query_ = fmt::format("SELECT id, name, type, {} FROM topics ORDER BY id",
                                    has_format ? "serialization_format" : "'cdr'");
        read_topics();
        messages_ = prepare(*database_, "SELECT rowid, topic_id, timestamp, data FROM messages WHERE rowid > ?1 "
                                        "ORDER BY rowid");
        if (!messages_) return false;
        restart();
        if (const auto ids = number("SELECT max(rowid) FROM messages")) last_id_ = *ids;
        return true;
    }

    [[nodiscard]] Result<std::optional<RecordedMessage>> next() override {
        while (!has_ended_) {
            const int result = sqlite3_step(messages_.get());
            if (result == SQLITE_DONE) {
                has_ended_ = true;
            } else if (result != SQLITE_ROW) {
                skip_damage();
            } else if (auto message = take_row()) {
                return message;
            }
        }
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] const std::vector<RecordedTopic>& topics() const override { return topics_.all(); }
    [[nodiscard]] const std::vector<RecordingLoss>& losses() const override { return losses_.listed(); }
    [[nodiscard]] std::uint64_t losses_count() const override { return losses_.count(); }
    [[nodiscard]] ReadProgress progress() const override { return {has_ended_ ? size_ : estimated_offset(), size_}; }

private:
    /// Returns the result of a query of one number.
    [[nodiscard]] std::optional<std::int64_t> number(const std::string& sql) const {
        const Statement statement = prepare(*database_, sql);
        if (!statement || sqlite3_step(statement.get()) != SQLITE_ROW) return std::nullopt;
        return sqlite3_column_int64(statement.get(), 0);
    }

    [[nodiscard]] std::uint64_t estimated_offset() const {
        if (last_id_ <= 0 || id_ <= 0) return 0;
        const double share = std::min(static_cast<double>(id_) / static_cast<double>(last_id_), 1.0);
        return static_cast<std::uint64_t>(share * static_cast<double>(size_));
    }

    void lose(std::string reason) { losses_.add(estimated_offset(), std::move(reason)); }

    void read_topics() {
        const Statement statement = prepare(*database_, topics_query_);
        int result = SQLITE_CORRUPT;
        while (statement && (result = sqlite3_step(statement.get())) == SQLITE_ROW) {
            const auto encoding = text_of(*statement, 3) == "cdr" ? MessageEncoding::kCdr : MessageEncoding::kOther;
            const auto topic =
                topics_.add({text_of(*statement, 1), type_without_msg(text_of(*statement, 2)), encoding});
            if (!topic) {
                lose("a topic, because there are too many or its name is too long");
            } else {
                topic_ids_.emplace(sqlite3_column_int64(statement.get(), 0), *topic);
            }
        }
        if (result != SQLITE_DONE) lose(fmt::format("topics: {}", sqlite3_errmsg(database_.get())));
    }

    /// Returns the message of the present row; nullopt if it cannot be used.
    [[nodiscard]] std::optional<RecordedMessage> take_row() {
        const auto id = sqlite3_column_int64(messages_.get(), 0);
        if (id <= id_) { // of a damaged page; to go on behind it would read the same messages again
            lose(fmt::format("message {}, which stands behind message {}", id, id_));
            return std::nullopt;
        }
        id_ = id;
        const auto topic_id = sqlite3_column_int64(messages_.get(), 1);
        const auto known = topic_ids_.find(topic_id);
        if (known == topic_ids_.end()) {
            lose(fmt::format("message {} of topic {}, which is not described", id_, topic_id));
            return std::nullopt;
        }
        const auto* data = static_cast<const char*>(sqlite3_column_blob(messages_.get(), 3));
        const auto size = static_cast<std::size_t>(sqlite3_column_bytes(messages_.get(), 3));
        if (data == nullptr && sqlite3_errcode(database_.get()) != SQLITE_OK &&
            sqlite3_errcode(database_.get()) != SQLITE_ROW) {
            lose(fmt::format("message {}: {}", id_, sqlite3_errmsg(database_.get())));
            return std::nullopt;
        }
        std::string_view bytes = data == nullptr ? std::string_view() : std::string_view(data, size);
        if (is_packed_message(topics_.all()[known->second].encoding, bytes)) {
            if (const auto reason = unpack_message(bytes, unpacked_)) {
                lose(fmt::format("message {}: {}", id_, *reason));
                return std::nullopt;
            }
        }
        return RecordedMessage{known->second, sqlite3_column_int64(messages_.get(), 2), bytes};
    }

    /// Continues behind id_.
    void restart() {
        sqlite3_reset(messages_.get());
        sqlite3_bind_int64(messages_.get(), 1, id_);
    }

    /// @return whether the first message whose id is greater than `id` can be read, or there is none
    [[nodiscard]] bool can_continue_behind(std::int64_t id) {
        id_ = id;
        restart();
        const int result = sqlite3_step(messages_.get());
        return result == SQLITE_ROW || result == SQLITE_DONE;
    }

    /// Continues behind messages whose pages are damaged: searches the next id that can be read, first in steps that
    /// double, then between the last two.
    void skip_damage() {
        const std::string reason = sqlite3_errmsg(database_.get());
        const std::int64_t before = id_;
        if (++damages_ > kDamagesMax) {
            lose(fmt::format("the messages behind number {}: more than {} damaged places", before, kDamagesMax));
            has_ended_ = true;
            return;
        }
        std::int64_t damaged = before;
        std::int64_t step = 1;
        while (damaged < last_id_ && !can_continue_behind(damaged + std::min(step, last_id_ - damaged))) {
            damaged += std::min(step, last_id_ - damaged);
            if (step <= last_id_ / 2) step *= 2;
        }
        if (damaged >= last_id_) {
            id_ = before;
            lose(fmt::format("the messages behind number {}: {}", before, reason));
            has_ended_ = true;
            return;
        }
        std::int64_t readable = damaged + std::min(step, last_id_ - damaged);
        while (readable - damaged > 1) {
            const std::int64_t middle = damaged + (readable - damaged) / 2;
            (can_continue_behind(middle) ? readable : damaged) = middle;
        }
        id_ = readable;
        lose(fmt::format("messages {} to {}: {}", before + 1, readable, reason));
        restart();
    }

    Database database_;
    Statement messages_;
    std::string topics_query_;
    std::uint64_t size_;
    std::uint64_t damages_ = 0; // that were skipped
    std::int64_t id_ = 0;       // of the message that was read last; the first one has 1
    std::int64_t last_id_ = std::numeric_limits<std::int64_t>::max();
    std::string unpacked_;
    std::unordered_map<std::int64_t, std::size_t> topic_ids_; // to topics
    TopicList topics_;
    LossList losses_;
    bool has_ended_ = false;
};

} // namespace

bool is_sqlite(std::string_view first_bytes) {
    return first_bytes.starts_with(std::string_view("SQLite format 3\0", 16));
}

Result<std::unique_ptr<Recording>> open_rosbag2(const std::filesystem::path& path) {
    std::error_code failed;
    const auto size = std::filesystem::file_size(path, failed);
    if (failed) return Error{Errc::kNotFound, fmt::format("{}: cannot be read: {}", path.string(), failed.message())};
    auto wal = path;
    wal += "-wal";
    const auto wal_size = std::filesystem::file_size(wal, failed);
    const bool has_wal = !failed && wal_size > 0;
    Database database = has_wal ? open_database(path, false) : nullptr;
    const bool lacks_wal = has_wal && !database;
    if (!database) database = open_database(path, true);
    if (database) {
        auto recording = std::make_unique<Rosbag2Recording>(std::move(database), size, lacks_wal);
        if (recording->prepare_reading()) return std::unique_ptr<Recording>(std::move(recording));
    }
    return Error{Errc::kMalformed,
                 fmt::format("{}: an SQLite database, but not one that rosbag2 recorded, or its first "
                             "pages are damaged; name the .db3 file of a rosbag2 recording",
                             path.string())};
}

} // namespace scanloom::robot
