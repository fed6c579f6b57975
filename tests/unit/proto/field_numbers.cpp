#include "tests/unit/proto/field_numbers.hpp"

#include <fmt/format.h>

#include <map>
#include <sstream>

namespace scanloom::proto {
namespace {

namespace pb = google::protobuf;
using Files = std::vector<const pb::FileDescriptor*>;

/// "scanloom.v1.Scan.seq" -> {1, "uint64"}
struct Entry {
    int number = 0;
    std::string type;

    friend bool operator==(const Entry&, const Entry&) = default;
};
using Entries = std::map<std::string, Entry>;

std::string type_of(const pb::FieldDescriptor& field) {
    std::string type = field.is_repeated() ? "repeated " : "";
    if (field.is_packed()) type += "packed ";
    switch (field.type()) {
    case pb::FieldDescriptor::TYPE_MESSAGE: return type + field.message_type()->full_name();
    case pb::FieldDescriptor::TYPE_ENUM: return type + field.enum_type()->full_name();
    default: return type + field.type_name();
    }
}

void add_enum(const pb::EnumDescriptor& type, Entries& entries) {
    for (int i = 0; i < type.value_count(); ++i) {
        entries[type.full_name() + "." + type.value(i)->name()] = {type.value(i)->number(), "enumerator"};
    }
}

void add_message(const pb::Descriptor& message, Entries& entries) {
    for (int i = 0; i < message.field_count(); ++i) {
        entries[message.full_name() + "." + message.field(i)->name()] = {message.field(i)->number(),
                                                                         type_of(*message.field(i))};
    }
    for (int i = 0; i < message.nested_type_count(); ++i) add_message(*message.nested_type(i), entries);
    for (int i = 0; i < message.enum_type_count(); ++i) add_enum(*message.enum_type(i), entries);
}

Entries entries_of(const Files& files) {
    Entries entries;
    for (const auto* file : files) {
        for (int i = 0; i < file->message_type_count(); ++i) add_message(*file->message_type(i), entries);
        for (int i = 0; i < file->enum_type_count(); ++i) add_enum(*file->enum_type(i), entries);
    }
    return entries;
}

Entries read_list(std::string_view list) {
    Entries entries;
    std::istringstream lines{std::string(list)};
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line.starts_with('#')) continue;
        const auto equals = line.find(" = ");
        const auto colon = line.find(" : ");
        entries[line.substr(0, equals)] = {std::stoi(line.substr(equals + 3)), line.substr(colon + 3)};
    }
    return entries;
}

std::string line_of(const std::string& name, const Entry& entry) {
    return fmt::format("{} = {} : {}", name, entry.number, entry.type);
}

/// Returns whether the message or enum that contained `name` reserves the number, or does not exist any longer. In that
/// case no data can have its type.
bool is_reserved(const Files& files, const std::string& name, int number) {
    const std::string owner = name.substr(0, name.rfind('.'));
    for (const auto* file : files) {
        if (const auto* message = file->pool()->FindMessageTypeByName(owner)) return message->IsReservedNumber(number);
        if (const auto* type = file->pool()->FindEnumTypeByName(owner)) return type->IsReservedNumber(number);
    }
    return true;
}

} // namespace

std::vector<std::string> lines_of(const Files& files) {
    std::vector<std::string> lines;
    for (const auto& [name, entry] : entries_of(files)) lines.push_back(line_of(name, entry));
    return lines;
}

std::vector<std::string> complaints_about(const Files& files, std::string_view list) {
    const Entries now = entries_of(files);
    const Entries listed = read_list(list);
    std::vector<std::string> complaints;
    for (const auto& [name, entry] : listed) {
        const auto found = now.find(name);
        if (found == now.end()) {
            if (is_reserved(files, name, entry.number)) continue;
            complaints.push_back(fmt::format("{} is gone; write `reserved {};` in its place", name, entry.number));
        } else if (found->second != entry) {
            complaints.push_back(fmt::format("{} was {}; leave it, and give what is new a new name and number",
                                             line_of(name, found->second), line_of(name, entry)));
        }
    }
    for (const auto& [name, entry] : now) {
        if (!listed.contains(name))
            complaints.push_back(fmt::format("{} is not listed; add this line", line_of(name, entry)));
    }
    return complaints;
}

} // namespace scanloom::proto
