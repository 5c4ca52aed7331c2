// Malicious files: a small file must not cost much memory or time, and a name must refer to a regular file.
#include <cstdlib>

#include "files/file.h"
#include "image/image.h"
#include "scene/scene.h"
#include "test_files.h"

namespace lab {
namespace {

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";

// A uniform picture.
Texture picture(uint32_t width, uint32_t height, uint8_t value) {
    return {width, height, std::vector<uint8_t>(4 * size_t{width} * height, value)};
}

std::string repeated(const std::string& text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += text;
    return all;
}

TEST(HostileImages, AllocateNoMoreThanTheirSizeExplains) {
    const TestFolder folder;
    // Run-length encoding keeps a file small: 17 MB are enough for 16384 x 16384 pixels, which take 3 GiB.
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n";
    std::vector<std::string> notes;
    EXPECT_USER_ERROR(read_radiance(folder.write("a.hdr", header + std::string(17 << 20, '\0')), notes),
                      "its pixels need 3072 MiB");

    write_exr(folder / "small.exr", {{1, 1, {1, 1, 1}}, {}, {}});
    std::string exr = file_bytes(folder / "small.exr");
    const uint32_t window[] = {0, 0, 16383, 16383};
    for (const std::string name : {"dataWindow", "displayWindow"})
        exr.replace(exr.find(name) + name.size() + 11, sizeof window, reinterpret_cast<const char*>(window), sizeof window);
    EXPECT_USER_ERROR(read_exr(folder.write("a.exr", exr + std::string(4 << 20, '\0'))), "its pixels need 3072 MiB");

    // 16 bits per channel are 2 GiB before they are reduced to 8.
    write_png(folder / "small.png", picture(1, 1, 0));
    std::string png = file_bytes(folder / "small.png");
    png.replace(16, 9, std::string("\0\0\x40\0\0\0\x40\0\x10", 9));
    EXPECT_USER_ERROR(read_texture(folder.write("a.png", png + std::string(40 << 10, '\0'))), "far more memory");
}

TEST(HostileImages, MayNotBePassedOverManyTimes) {
    const TestFolder folder;
    write_jpg(folder / "a.jpg", picture(8, 8, 200));
    const std::string jpg = file_bytes(folder / "a.jpg"), scan("\xff\xda\x00\x02", 4);
    EXPECT_NO_THROW(read_texture(folder.write("b.jpg", jpg + repeated(scan, 63))));
    EXPECT_USER_ERROR(read_texture(folder.write("b.jpg", jpg + repeated(scan, 64))), "damaged");
}

TEST(HostileMeshes, ReadAMaterialFileOnce) {
    const TestFolder folder;
    folder.write("a.mtl", "newmtl m\nunknown 1\n");
    const auto load = [&](const std::string& text) { return load_scene(folder.write("a.obj", text + triangle)); };
    EXPECT_EQ(load(repeated("mtllib a.mtl\nmtllib ./a.mtl\n", 100)).warnings.size(),
              3u);  // grey faces and white sky, too
    std::string names, lines;
    for (int i = 0; i < 257; ++i) {
        names += " x" + std::to_string(i);
        lines += "mtllib " + repeated("./", i) + "a.mtl\n";
    }
    EXPECT_USER_ERROR(load("mtllib" + names + "\n"), "more than 256 names");
    EXPECT_USER_ERROR(load(lines), "more than 256 names");
}

// Needs 1.5 GB.
TEST(HostileMeshes, AllocateNoMoreThanTheirSizeExplains_all) {
    const TestFolder folder;
    EXPECT_USER_ERROR(load_scene(folder.write("a.obj", triangle + repeated("f" + repeated(" 1", 256) + "\n", 135000))),
                      "far more memory");
}

// A scene may refer to files anywhere, as those in assets/scenes do, but only to regular ones.
TEST(HostileNames, LeadToAnyRegularFile) {
    const TestFolder folder, elsewhere;
    write_png(elsewhere / "a.png", picture(1, 1, 7));
    elsewhere.write("a.mtl", "newmtl m\nmap_Kd a.png\n");
    const std::string absolute = (elsewhere / "").generic_string(),
                      upwards = "../" + (elsewhere / "").parent_path().filename().string() + "/";
    for (const std::string& path : {absolute, upwards}) {
        folder.write("a.mtl", "newmtl m\nmap_Kd " + path + "a.png\n");
        folder.write("a.obj", "mtllib a.mtl\nusemtl m\n" + triangle);
        EXPECT_EQ(load_scene(folder / "a.obj").textures.at(0).pixels[0], 7) << "map_Kd " << path;
        // map_Kd is relative to the mesh, not to its material file.
        folder.write("b.obj", "mtllib " + path + "a.mtl\nusemtl m\n" + triangle);
        EXPECT_USER_ERROR(load_scene(folder / "b.obj"), (folder / "a.png").string() + ": no such file");
        elsewhere.write("c.obj", "mtllib a.mtl\nusemtl m\n" + triangle);
        const auto scene = folder.write("a.json", "{\"meshes\":[{\"file\":\"" + path + "c.obj\"}]}");
        EXPECT_EQ(load_scene(scene).textures.at(0).pixels[0], 7) << "meshes " << path;
    }
    for (const std::string name : {".", "/"}) {
        EXPECT_USER_ERROR(load_scene(folder.write("a.obj", "mtllib " + name + "\n" + triangle)), "not a regular file");
        folder.write("a.mtl", "newmtl m\nmap_Kd " + name + "\n");
        EXPECT_USER_ERROR(load_scene(folder.write("a.obj", "mtllib a.mtl\nusemtl m\n" + triangle)), "not a regular file");
        EXPECT_USER_ERROR(load_scene(folder.write("a.json", "{\"meshes\":[{\"file\":\"" + name + "\"}]}")), "not a regular file");
    }
}

// Messages contain neither escape sequences, which a terminal would obey, nor line breaks.
TEST(HostileNames, AreSafeToPrint) {
    EXPECT_EQ(printable("a\nb\x1b[2J\x7f\u00e9"), "a?b?[2J?\u00e9");
    const TestFolder folder;
    const std::string name = "a\x1b[2J";
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "a?[2J",
                        load_scene(folder.write("a.obj", "mtllib " + name + "\n" + triangle)).warnings.at(0));
    folder.write("a.mtl", "newmtl m\nmap_Kd " + name + "\n");
    EXPECT_USER_ERROR(load_scene(folder.write("a.obj", "mtllib a.mtl\nusemtl m\n" + triangle)), "a?[2J");
    EXPECT_USER_ERROR(load_scene(folder.write("a.json", R"({"meshes":[{"file":"a\nb.obj"}]})")), "a?b.obj");
    EXPECT_USER_ERROR(load_scene(folder.write("a.json", R"({"meshes":[],"background":{"light_probe":"a\nb"}})")), "a?b");
    EXPECT_USER_ERROR(load_scene(folder.write("a.json", "{\"meshes\": \x7f\x01}")), "not valid JSON");
}

TEST(HostileNames, MayBeLongerThanTheFileSystemAllows) {
    const TestFolder folder;
    const std::string name(5000, 'x');
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "xxx...\"",
                        load_scene(folder.write("a.obj", "mtllib " + name + "\n" + triangle)).warnings.at(0));
    folder.write("a.mtl", "newmtl m\nmap_Kd " + name + "\n");
    EXPECT_USER_ERROR(load_scene(folder.write("a.obj", "mtllib a.mtl\nusemtl m\n" + triangle)), "xxx");
    EXPECT_USER_ERROR(load_scene(folder.write("a.json", "{\"meshes\":[{\"file\":\"" + name + "\"}]}")), "xxx");
}

}  // namespace
}  // namespace lab
