#include "files/cache.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace lab {
namespace {

TEST(Cache, NamesDifferByKindAndByKey) {
    std::set<std::string> names;
    for (const char* kind : {"shader", "native"})
        for (const char* key : {"", "a", "b", "ab", "ba"}) names.insert(cache_name(kind, key));
    EXPECT_EQ(names.size(), 10u);
    for (const std::string& name : names)
        EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), std::string::npos);
}

TEST(Cache, NamesOfEqualTextsAreEqual) { EXPECT_EQ(cache_name("shader", std::string("text")), cache_name("shader", "text")); }

}  // namespace
}  // namespace lab
