// Caches compiled shaders, pipelines and backend choices between runs. A damaged entry counts as absent. Beyond 512 MB of
// entries, those go that were read or written longest ago.
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

// Replaces the entry atomically. Returns why that is not possible, or nothing: for most, the next start just takes longer.
std::string write_cache(const std::string& name, std::string_view contents);

}  // namespace lab
