#include "scene/json_object.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "error.h"
#include "files/file.h"
#include "scene/text_lines.h"

namespace lab {

using nlohmann::json;

namespace {

// Deeper than any scene file: a file full of brackets must not exhaust memory.
constexpr int max_depth = 16;

bool is_number(const json& value) {
    return value.is_number() && std::abs(value.get<double>()) <= std::numeric_limits<float>::max();
}

}  // namespace

json parse_json(const std::string& file, const std::string& text) {
    std::vector<std::set<std::string>> keys;  // of the objects around the current place
    const auto check = [&](int depth, json::parse_event_t event, const json& value) {
        if (depth > max_depth) throw UserError(file + ": brackets are nested more than 16 deep");
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
            throw UserError(file + ": the key " + in_quotes(value.get<std::string>()) +
                            " stands twice in one object: remove one");
        return true;
    };
    try {
        return json::parse(text, check);
    } catch (const json::parse_error& error) {
        const size_t end = std::min(error.byte, text.size());
        const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
        // The library's message starts with the position.
        std::string reason = error.what();
        if (const size_t start = reason.find(": "); start != std::string::npos) reason.erase(0, start + 2);
        fail_at_line(file, static_cast<size_t>(line), "not valid JSON: " + printable(reason.substr(0, 200)));
    } catch (const json::exception& error) {
        throw UserError(file + ": not valid JSON: " + printable(error.what()).substr(0, 200));
    }
}

JsonObject::JsonObject(const json& value, std::string file, std::string where, std::initializer_list<const char*> known)
    : value_(value), file_(std::move(file)), where_(std::move(where)) {
    if (!value.is_object()) throw UserError(file_ + ": " + where_ + " must be an object: {...}");
    for (const auto& [key, unused] : value.items()) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        std::string list;
        for (const char* name : known) list += (list.empty() ? "" : ", ") + std::string(name);
        throw UserError(file_ + ": unknown key " + in_quotes(key) + " in " + where_ + "; known keys are " + list);
    }
}

JsonObject JsonObject::object(const char* key, std::initializer_list<const char*> known) const {
    return {value_.at(key), file_, in_quotes(key), known};
}

const json& JsonObject::array(const char* key) const {
    if (!has(key)) fail(key, "is missing");
    if (!value_.at(key).is_array()) fail(key, "must be a list: [...]");
    return value_.at(key);
}

std::optional<double> JsonObject::number(const char* key, const char* rule) const {
    if (!has(key)) return std::nullopt;
    if (!value_.at(key).is_number()) fail(key, rule);
    if (!is_number(value_.at(key))) fail(key, "is beyond 3.4e38, the largest number of 32 bits");
    return value_.at(key).get<double>();
}

std::optional<vec3> JsonObject::vector(const char* key) const {
    if (!has(key)) return std::nullopt;
    const json& list = value_.at(key);
    if (!list.is_array() || list.size() != 3 || !std::all_of(list.begin(), list.end(), is_number))
        fail(key, "must be three numbers of 32 bits: [x, y, z]");
    return vec3(list[0].get<float>(), list[1].get<float>(), list[2].get<float>());
}

std::optional<vec3> JsonObject::number_or_vector(const char* key) const {
    if (has(key) && value_.at(key).is_array()) return vector(key);
    const std::optional<double> value = number(key);
    return value ? std::optional<vec3>(vec3(static_cast<float>(*value))) : std::nullopt;
}

std::optional<uint32_t> JsonObject::integer(const char* key, uint32_t low, uint32_t high) const {
    const std::optional<double> value = number(key);
    if (!value) return std::nullopt;
    if (*value != std::floor(*value) || *value < low || *value > high)
        fail(key, "must be a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    return static_cast<uint32_t>(*value);
}

std::optional<bool> JsonObject::boolean(const char* key) const {
    if (!has(key)) return std::nullopt;
    if (!value_.at(key).is_boolean()) fail(key, "must be true or false");
    return value_.at(key).get<bool>();
}

std::optional<std::string> JsonObject::text(const char* key) const {
    if (!has(key)) return std::nullopt;
    if (!value_.at(key).is_string()) fail(key, "must be a text in double quotes");
    return value_.at(key).get<std::string>();
}

void JsonObject::fail(const char* key, const std::string& reason) const {
    throw UserError(file_ + ": " + in_quotes(key) + " in " + where_ + " " + reason);
}

}  // namespace lab
