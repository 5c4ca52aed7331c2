// Caches compiled shaders, pipelines and backend choices between runs. Failing to read or write an entry is silent; a damaged
// entry counts as absent.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lab {

// The name of the entry for `key`, such as a source. Two hashes make a chance collision impossible in practice.
std::string cache_name(const std::string& kind, std::string_view key);

// Contents of the entry `name`, if it exists.
std::optional<std::string> read_cache(const std::string& name);

// The entry's file; empty if there is no cache folder.
std::filesystem::path cache_file(const std::string& name);

// Replaces the entry atomically.
void write_cache(const std::string& name, std::string_view contents);

}  // namespace lab
