// Files that save time on the next start: compiled shaders and pipelines. Losing them costs nothing else, so
// every failure to read or write one is silent, and a damaged one counts as absent.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace lab {

// Contents of the cache entry `name`, if there is an undamaged one.
std::optional<std::string> read_cache(const std::string& name);

// Replaces the entry in one step, so that other processes see the old or the new one.
void write_cache(const std::string& name, std::string_view contents);

}  // namespace lab
