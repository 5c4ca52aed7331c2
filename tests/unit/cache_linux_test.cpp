// Caches in a folder of their own, which Windows names otherwise.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "files/cache.h"
#include "files/file.h"
#include "test_files.h"

namespace lab {
namespace {

// Of files without contents on the disk, which take no room.
TEST(Cache, WhatWasUsedLongestAgoGoesWhereThereIsMuch) {
    namespace fs = std::filesystem;
    const TestFolder folder;
    setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
    const auto add = [&](const std::string& name, uintmax_t size, int hours_ago) {
        if (size > 0) {
            write_file(cache_file(name), std::string("x"));
            fs::resize_file(cache_file(name), size);
        }
        fs::last_write_time(cache_file(name), fs::file_time_type::clock::now() - std::chrono::hours(hours_ago));
    };
    EXPECT_EQ(write_cache("read", "text"), "");
    add("read", 0, 9);
    add("older", 300 << 20, 8);
    add("newer", 300 << 20, 7);
    EXPECT_EQ(read_cache("read"), "text");
    EXPECT_EQ(write_cache("written", "text"), "");
    EXPECT_FALSE(fs::exists(cache_file("older")));
    for (const char* name : {"read", "newer", "written"}) EXPECT_TRUE(fs::exists(cache_file(name))) << name;
    unsetenv("XDG_CACHE_HOME");
}

TEST(Cache, SaysWhyItCannotBeWritten) {
    const TestFolder folder;
    setenv("XDG_CACHE_HOME", folder.write("file", "").c_str(), 1);
    EXPECT_NE(write_cache("name", "text").find("cannot be written"), std::string::npos);
    unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace lab
