// Temporary files, and errors as text.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>

#include "error.h"
#include "tests/support/temporary_folder.h"

namespace lab {

// A new empty folder, removed at the end of its scope.
class TestFolder : public TemporaryFolder {
  public:
    std::filesystem::path operator/(const std::string& name) const { return path() / name; }

    // Writes a file and returns its path.
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::filesystem::create_directories((path() / name).parent_path());
        // Some file systems wait for the disk when a file is overwritten.
        std::filesystem::remove(path() / name);
        std::ofstream(path() / name, std::ios::binary) << bytes;
        return path() / name;
    }

    size_t file_count() const { return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(path()), {})); }
};

inline std::string file_bytes(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// The message of the UserError that a call must throw: a single line, not too long.
inline std::string user_error(const std::function<void()>& call) {
    try {
        call();
    } catch (const UserError& error) {
        std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_LT(message.size(), 600u) << message;
        return message;
    }
    ADD_FAILURE() << "no UserError was thrown";
    return "";
}

#define EXPECT_USER_ERROR(call, part) EXPECT_PRED_FORMAT2(::testing::IsSubstring, part, user_error([&] { call; }))

// Reads a valid file truncated at 200 places and, 200 times, with a few bytes changed. Each read must succeed or throw a
// UserError; truncated files must be refused if `cut_is_error`.
inline void damage(const TestFolder& folder, const std::string& name, const std::string& valid, bool cut_is_error,
                   const std::function<void(const std::filesystem::path&)>& read) {
    std::mt19937 random(20240229);
    const auto below = [&](size_t bound) { return std::uniform_int_distribution<size_t>(0, bound - 1)(random); };
    ASSERT_NO_THROW(read(folder.write(name, valid)));
    for (int i = 0; i < 400; ++i) {
        const bool cut = i < 200;
        std::string bytes = valid;
        if (cut) bytes.resize(below(valid.size()));
        // Headers are most sensitive: half of the changes go there.
        for (size_t changes = cut ? 0 : 1 + below(4); changes > 0; --changes)
            bytes[below(below(2) ? valid.size() : std::min<size_t>(valid.size(), 400))] = static_cast<char>(below(256));
        bool refused = false;
        try {
            read(folder.write(name, bytes));
        } catch (const UserError& error) {
            refused = true;
            EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << error.what();
        } catch (const std::exception& error) {
            ADD_FAILURE() << "damaged " << name << " number " << i << ": " << error.what();
        }
        EXPECT_TRUE(refused || !(cut && cut_is_error)) << name << " cut to " << bytes.size() << " bytes was accepted";
    }
}

}  // namespace lab
