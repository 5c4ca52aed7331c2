// What only Linux lets us simulate: a full disk, fewer processors, and names of pipes and devices.
#include <sched.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>

#include "bvh_triangles.h"
#include "files/file.h"
#include "image/image.h"
#include "parallel.h"
#include "platform.h"
#include "scene/scene.h"
#include "test_files.h"

namespace lab {
namespace {

// Large enough for all threads to share the first splits.
TEST(BvhBuilder, DoesNotDependOnTheNumberOfThreads) {
    const auto triangles = height_field(300);
    const Bvh parallel = build_bvh(triangles);
    cpu_set_t all, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof(all), &all), 0);
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
    EXPECT_EQ(processor_count(), 1u);
    const Bvh serial = build_bvh(triangles);
    sched_setaffinity(0, sizeof(all), &all);
    expect_same(parallel, serial);
    expect_same(parallel, build_bvh(triangles));
}

TEST(WriteFile, FullDiskKeepsTheOlderFile) {
    const TestFolder folder;
    folder.write("a.exr", "older contents");
    // A limit on the file size simulates a full disk.
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit limit{10000, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string message = user_error([&] { write_file(folder / "a.exr", std::string(100'000, 'x')); });
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_PRED_FORMAT2(::testing::IsSubstring, "cannot be written", message);
    EXPECT_EQ(file_bytes(folder / "a.exr"), "older contents");
    EXPECT_EQ(folder.file_count(), 1u) << "a temporary file was left behind";
}

TEST(WriteFile, FollowsLinksAndKeepsTheMode) {
    const TestFolder folder, elsewhere;
    namespace fs = std::filesystem;
    constexpr auto mode = fs::perms::owner_read | fs::perms::owner_write;
    fs::permissions(elsewhere.write("a.png", "older contents"), mode);
    fs::create_symlink(elsewhere / "a.png", folder / "second.png");
    fs::create_symlink("second.png", folder / "first.png");
    check_writable(folder / "first.png");
    EXPECT_EQ(file_bytes(elsewhere / "a.png"), "older contents");
    write_file(folder / "first.png", "contents");
    EXPECT_TRUE(fs::is_symlink(folder / "first.png") && fs::is_symlink(folder / "second.png"));
    EXPECT_EQ(file_bytes(elsewhere / "a.png"), "contents");
    EXPECT_EQ(fs::status(elsewhere / "a.png").permissions(), mode);

    fs::create_symlink("new.png", folder / "dangling.png");
    write_file(folder / "dangling.png", "contents");
    EXPECT_EQ(file_bytes(folder / "new.png"), "contents");
    fs::create_symlink("loop.png", folder / "loop.png");
    EXPECT_USER_ERROR(check_writable(folder / "loop.png"), "too many symbolic links");
    mkfifo((folder / "pipe").c_str(), 0600);
    fs::create_symlink("pipe", folder / "pipe.png");
    for (const char* name : {"pipe", "pipe.png"}) EXPECT_USER_ERROR(write_file(folder / name, "contents"), "not a regular file");
    EXPECT_EQ(folder.file_count(), 7u) << "a temporary file was left behind";
    EXPECT_EQ(elsewhere.file_count(), 1u) << "a temporary file was left behind";
}

// As a render does whose outputs are one file by two names.
TEST(WriteFile, ThreadsMayWriteTheSameFile) {
    const TestFolder folder;
    const std::string bytes(10'000, 'x');
    EXPECT_NO_THROW(in_parallel(200, 1, [&](size_t, size_t) { write_file(folder / "a.exr", bytes); }));
    EXPECT_EQ(file_bytes(folder / "a.exr"), bytes);
    EXPECT_EQ(folder.file_count(), 1u);
}

TEST(CheckWritable, RefusesAFolderOfTheSystem) { EXPECT_USER_ERROR(check_writable("/proc/a.png"), "cannot be written"); }

// Reading one would block forever.
TEST(ReadFile, RefusesPipesAndDevices) {
    const TestFolder folder;
    mkfifo((folder / "pipe").c_str(), 0600);
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (const std::string name : {"/dev/zero", "/dev/stdin", "pipe"}) {
        EXPECT_USER_ERROR(load_scene(folder.write("a.obj", "mtllib " + name + "\n" + triangle)), "not a regular file");
        folder.write("a.mtl", "newmtl m\nmap_Kd " + name + "\n");
        EXPECT_USER_ERROR(load_scene(folder.write("b.obj", "mtllib a.mtl\nusemtl m\n" + triangle)), "not a regular file");
        EXPECT_USER_ERROR(load_scene(folder.write("a.json", "{\"meshes\":[{\"file\":\"" + name + "\"}]}")), "not a regular file");
        EXPECT_USER_ERROR(read_exr(folder / name), "not a regular file");
        EXPECT_USER_ERROR(read_texture(folder / name), "not a regular file");
    }
}

TEST(Platform, OutlivesAStepThatBringsDownItsProgram) {
    EXPECT_FALSE(would_survive([]() -> int { std::abort(); }));
    std::signal(SIGSEGV, [](int) { _exit(3); });  // as in a program under a limit of memory
    EXPECT_FALSE(would_survive([] { return std::raise(SIGSEGV); }));
    std::signal(SIGSEGV, SIG_DFL);
    EXPECT_TRUE(would_survive([] { return 1; }));
}

}  // namespace
}  // namespace lab
