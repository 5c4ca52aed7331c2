// JSON objects with errors that name the file and the key.
#pragma once
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "shaders/interface.h"

namespace lab {

// Parses JSON. Throws UserError for syntax errors, with the line number, for deep nesting, and for a key that stands twice.
nlohmann::json parse_json(const std::string& file, const std::string& text);

// An object whose keys are read one by one. Throws UserError for values of the wrong type or out of range; absent keys give an
// empty result. All numbers are finite.
class JsonObject {
  public:
    // Errors call the object `where`. Throws UserError if it is not an object or has a key that is not `known`.
    JsonObject(const nlohmann::json& value, std::string file, std::string where, std::initializer_list<const char*> known);

    bool has(const char* key) const { return value_.contains(key); }
    JsonObject object(const char* key, std::initializer_list<const char*> known) const;
    const nlohmann::json& array(const char* key) const;

    // `rule` is what an error says of a value that is no number.
    std::optional<double> number(const char* key, const char* rule = "must be a number") const;
    std::optional<vec3> vector(const char* key) const;            // three numbers
    std::optional<vec3> number_or_vector(const char* key) const;  // a single number stands for three equal ones
    std::optional<uint32_t> integer(const char* key, uint32_t low, uint32_t high) const;
    std::optional<bool> boolean(const char* key) const;
    std::optional<std::string> text(const char* key) const;

    // The value; throws UserError if the key is absent.
    template <typename Value>
    Value required(const char* key, const std::optional<Value>& value) const {
        if (!value) fail(key, "is missing");
        return *value;
    }

    [[noreturn]] void fail(const char* key, const std::string& reason) const;

  private:
    const nlohmann::json& value_;
    std::string file_;
    std::string where_;
};

}  // namespace lab
