#pragma once

#include <google/protobuf/descriptor.h>

#include <string>
#include <string_view>
#include <vector>

/// Keeps old bytes readable: field_numbers.txt lists every field and enumerator there ever was.
namespace scanloom::proto {

/// The fields and enumerators of these files, one "name = number : type" each, sorted.
[[nodiscard]] std::vector<std::string> lines_of(const std::vector<const google::protobuf::FileDescriptor*>& files);

/// How these files break with the list, a sentence each; empty: they do not.
/// A field keeps its name, number and type for ever, or is gone with its number reserved.
[[nodiscard]] std::vector<std::string>
complaints_about(const std::vector<const google::protobuf::FileDescriptor*>& files, std::string_view list);

} // namespace scanloom::proto
