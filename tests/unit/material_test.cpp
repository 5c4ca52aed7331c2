// MTL files: what each keyword means, and what the loader refuses.
#include <cmath>
#include <cstring>

#include "mesh_fixture.h"
#include "scene/features.h"

namespace lab {
namespace {

using testing::IsSubstring;

TEST_F(MeshFile, DiffuseAndEmission) {
    const Material all = material("Kd 0.25 0.5 1\nKe 1 20 300\n");
    EXPECT_EQ(all.diffuse_albedo, vec3(0.25f, 0.5f, 1));
    EXPECT_EQ(all.emission, vec3(1, 20, 300));
    EXPECT_EQ(all.albedo_texture, -1);
    EXPECT_EQ(all.refractive_index, 0);
    EXPECT_EQ(all.absorption, vec3(0));
    EXPECT_EQ(material("Ke 1 1 1").diffuse_albedo, vec3(0));
}

TEST_F(MeshFile, FacesWithoutAMaterialAreGrey) {
    for (const std::string usemtl : {"", "usemtl anything\n"}) {
        const Scene scene = load(usemtl + corners_of_a_square + "f 1 2 3\nf 1 3 4\n");
        EXPECT_EQ(scene.materials.size(), 1u);
        EXPECT_EQ(scene.materials.at(0).diffuse_albedo, vec3(0.5f));
        EXPECT_EQ(count_warnings(scene, "2 faces without a material"), 1u);
    }
}

TEST_F(MeshFile, SpecularIsIgnoredUnlessAskedFor) {
    const Scene ignored = load_material("Kd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 30");
    EXPECT_EQ(ignored.materials.at(0).specular_albedo, vec3(0));
    EXPECT_EQ(count_warnings(ignored, "Ks is ignored"), 1u);
    const Scene used = load_material("Kd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 30", true);
    EXPECT_EQ(used.materials.at(0).specular_albedo, vec3(0.25f));
    EXPECT_EQ(used.materials.at(0).specular_exponent, 30);
    EXPECT_EQ(count_warnings(used, "Ks"), 0u);
    folder.write("a.json", R"({"meshes": [{"file": "a.obj"}], "specular": true})");
    EXPECT_EQ(load_scene(folder / "a.json").materials.at(0).specular_albedo, vec3(0.25f));
    EXPECT_EQ(count_warnings(load_material("Kd 1 1 1\nKs 0 0 0"), "Ks"), 0u);
}

TEST_F(MeshFile, ExponentsEndWhereDirectionsAreExactTo) {
    const Scene wide = load_material("Kd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 1e8", true);
    EXPECT_EQ(wide.materials.at(0).specular_exponent, 1e8f);
    EXPECT_EQ(count_warnings(wide, "Ns"), 0u);
    const Scene narrow = load_material("Kd 0.5 0.5 0.5\nKs 0.25 0.25 0.25\nNs 1e30", true);
    EXPECT_EQ(narrow.materials.at(0).specular_exponent, 1e8f);
    EXPECT_EQ(count_warnings(narrow, "Ns above 1e8"), 1u);
}

TEST_F(MeshFile, NoMaterialReflectsMoreThanItReceives) {
    const Scene diffuse = load_material("Kd 2 1 0.5\nKs 3 3 3");
    EXPECT_EQ(count_warnings(diffuse, "\"m\" reflects more"), 1u);
    EXPECT_LE(diffuse.materials.at(0).diffuse_albedo.x, 1);
    EXPECT_NEAR(diffuse.materials.at(0).diffuse_albedo.x, 1, 1e-6f);
    EXPECT_NEAR(diffuse.materials.at(0).diffuse_albedo.z, 0.25, 1e-6f);

    for (const char* lines : {"Kd 0.9 0.1 0.3\nKs 0.3 0.1 0.8", "Kd 1 1 1\nKs 1e-3 1 1", "Kd 1e38 0 0\nKs 3e38 1 1"}) {
        const Scene both = load_material(lines, true);
        EXPECT_EQ(count_warnings(both, "Kd and Ks"), 1u) << lines;
        const vec3 sum = both.materials.at(0).diffuse_albedo + both.materials.at(0).specular_albedo;
        EXPECT_LE(std::max({sum.x, sum.y, sum.z}), 1) << lines;
        EXPECT_NEAR(std::max({sum.x, sum.y, sum.z}), 1, 1e-6f) << lines;
    }
    EXPECT_EQ(load_material("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5", true).warnings.size(), 1u) << "the white sky alone";
}

TEST_F(MeshFile, Dielectrics) {
    EXPECT_EQ(material("d 0.5\nNi 1.5").refractive_index, 1.5f);
    EXPECT_EQ(material("Tr 0.1\nNi 1.33").refractive_index, 1.33f);
    EXPECT_EQ(material("d 0").refractive_index, 1.0f) << "Ni is 1 where it is not given";
    EXPECT_EQ(material("d 1\nNi 1.5").refractive_index, 0);
    EXPECT_EQ(material("Tr 0\nNi 1.5").refractive_index, 0);

    EXPECT_EQ(material("d 0\nNi 1.5").absorption, vec3(0)) << "no Tf means clear";
    EXPECT_EQ(material("d 0\nNi 1.5\nTf 1 1 1").absorption, vec3(0));
    const vec3 absorption = material("d 0\nNi 1.5\nTf 0.5 1 0.25").absorption;
    EXPECT_FLOAT_EQ(absorption.x, std::log(2.0f));
    EXPECT_EQ(absorption.y, 0);
    EXPECT_FLOAT_EQ(absorption.z, std::log(4.0f));
    EXPECT_EQ(material("Kd 1 1 1\nTf 0 0 0\nNi 0").absorption, vec3(0)) << "opaque: neither matters";
}

TEST_F(MeshFile, DielectricTrianglesComeLast) {
    folder.write("a.mtl", "newmtl glass\nd 0\nNi 1.5\nnewmtl wall\nKd 1 1 1\n");
    const Scene scene =
        load("mtllib a.mtl\n" + corners_of_a_square + "usemtl glass\nf 1 2 3\nusemtl wall\nf 1 2 4\nusemtl glass\nf 1 3 4\n");
    std::vector<float> indices;
    for (const uint32_t m : scene.triangle_materials) indices.push_back(scene.materials.at(m).refractive_index);
    EXPECT_EQ(indices, (std::vector<float>{0, 1.5f, 1.5f}));
    EXPECT_EQ(scene.meshes.at(0).dielectric_count, 2u);
    const std::vector<MaterialClassRange> ranges = material_class_ranges({"", 10, 7, 2});
    ASSERT_EQ(ranges.size(), 2u);
    EXPECT_EQ(ranges[0].first_triangle, 10u);
    EXPECT_EQ(ranges[0].triangle_count, 5u);
    EXPECT_EQ(ranges[1].material_class, MATERIAL_CLASS_DIELECTRIC);
    EXPECT_EQ(ranges[1].first_triangle, 15u);
    EXPECT_EQ(ranges[1].triangle_count, 2u);
    EXPECT_EQ(material_class_ranges({"", 0, 3, 3}).size(), 1u);
}

TEST_F(MeshFile, KeywordsWithoutEffectAreNamed) {
    const Scene scene =
        load_material("Ka 1 1 1\nillum 2\nKd 1 1 1\nmap_Bump b.png\nPs 0.5\nmap_Bump c.png\nmap_Pr r.png\nnorm n.png");
    EXPECT_EQ(count_warnings(scene, "without effect here: \"Ps\", \"map_Bump\", \"map_Pr\", \"norm\""), 1u);
}

TEST_F(MeshFile, RoughnessMakesMicrofacets) {
    const auto microfacets = [&](const std::string& lines) { return load_material(lines).microfacets.at(0); };
    const Microfacets plastic = microfacets("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nPr 0.5\nNi 1.45"),
                      metal = microfacets("Pr 0.2\nPm 1");
    EXPECT_FLOAT_EQ(plastic.roughness, 0.25f);
    EXPECT_EQ(plastic.metalness, 0);
    EXPECT_FLOAT_EQ(plastic.coat_index, 1.45f);
    EXPECT_FLOAT_EQ(metal.roughness, 0.04f);
    EXPECT_EQ(metal.metalness, 1);
    EXPECT_EQ(metal.coat_index, 1.5f) << "of most plastics, where Ni is not stated";
    EXPECT_EQ(load_material("Ks 1 1 1\nPr 0.5", true).materials.at(0).specular_albedo, vec3(0)) << "instead of Phong's lobe";

    const Scene glass = load_material("d 0\nNi 1.5\nPr 0.5\nTf 0.5 1 1");
    EXPECT_FLOAT_EQ(glass.microfacets.at(0).roughness, 0.25f);
    EXPECT_FLOAT_EQ(glass.materials.at(0).absorption.x, std::log(2.0f));
    EXPECT_TRUE(load_material("Kd 1 1 1\nKs 1 1 1\nNs 10", true).microfacets.empty());
    EXPECT_FALSE(features_of(load_material("Kd 1 1 1")).microfacets);
    EXPECT_TRUE(features_of(glass).microfacets);
}

TEST_F(MeshFile, SmoothGlassHasNoMicrofacets) {
    const std::string glass = "d 0\nNi 1.5\nTf 0.5 1 1\n";
    for (const char* roughness : {"Pr 0", "Pr 0.0001", "Pr 0\nPm 0"}) {
        const Scene smooth = load_material(glass + roughness), plain = load_material(glass);
        EXPECT_TRUE(smooth.microfacets.empty()) << roughness;
        EXPECT_EQ(features_of(smooth).defines(), features_of(plain).defines());
        EXPECT_EQ(std::memcmp(smooth.materials.data(), plain.materials.data(), sizeof(Material)), 0);
    }
    EXPECT_TRUE(load_material("d 0\nNi 1\nPr 0.5").microfacets.empty()) << "nothing bends";
}

TEST_F(MeshFile, MicrofacetsThatContradictThemselvesSaySo) {
    const Scene mirror = load_material("Pr 0\nPm 1");
    EXPECT_FLOAT_EQ(mirror.microfacets.at(0).roughness, 1e-4f);
    EXPECT_EQ(count_warnings(mirror, "\"m\": Pr below 0.01"), 1u);
    EXPECT_EQ(count_warnings(load_material("Pm 1"), "Pm has no effect without Pr"), 1u);
    EXPECT_EQ(count_warnings(load_material("Pm 0"), "Pm"), 0u);
    const Scene glass = load_material("d 0.5\nNi 1.5\nPr 0.5\nPm 1");
    EXPECT_EQ(count_warnings(glass, "is transparent (d < 1 or Tr > 0), so that Pm has no effect"), 1u);
    EXPECT_EQ(glass.microfacets.at(0).metalness, 0);
    EXPECT_EQ(count_warnings(load_material("Pr 0.5\nTf 0.5 1 1"), "is opaque (d is 1), so that Tf has no effect"), 1u);
    EXPECT_EQ(count_warnings(load_material("Pr 0.5\nTf 1 1 1"), "Tf"), 0u);
    EXPECT_EQ(count_warnings(load_material("Tf 0.5 1 1"), "Tf"), 0u);
}

TEST_F(MeshFile, OneNumberStandsForThreeAndHalosHaveNoEffect) {
    EXPECT_EQ(load_material("Kd 0.25").materials.at(0).diffuse_albedo, vec3(0.25f));
    EXPECT_EQ(load_material("Kd 0.25 # grey\nKe 2").materials.at(0).emission, vec3(2));
    const Scene halo = load_material("d -halo 0.5\nNi 1.5\nTf 0.5");
    EXPECT_EQ(halo.materials.at(0).absorption, load_material("d 0.5\nNi 1.5\nTf 0.5 0.5 0.5").materials.at(0).absorption);
    EXPECT_EQ(count_warnings(halo, "without effect here: -halo"), 1u);
    EXPECT_USER_ERROR(load_material("d -halo"), "d needs a number");
}

TEST_F(MeshFile, MaterialFileNamesMayHaveSpaces) {
    folder.write("two words.mtl", "newmtl light grey\nKd 0.75 0.75 0.75\n");
    for (const char* name : {"two words.mtl", "two\\ words.mtl", "  two words.mtl "})
        EXPECT_EQ(load("mtllib " + std::string(name) + "\nusemtl light grey \n" + corners_of_a_square + "f 1 2 3\n")
                      .materials.at(0)
                      .diffuse_albedo,
                  vec3(0.75f));
    folder.write("words.mtl", "newmtl light grey\nKd 0.75 0.75 0.75\n");
    EXPECT_NO_THROW(load("mtllib missing.mtl words.mtl\nusemtl light grey\n" + corners_of_a_square + "f 1 2 3\n"));
}

TEST_F(MeshFile, DamagedMaterialsNameFileAndLine) {
    const std::pair<const char*, const char*> cases[] = {
        {"Kd 1 1", "a.mtl:2: Kd needs 3 numbers"},
        {"\nKd 1 nan 1", "a.mtl:3: Kd \"nan\""},
        {"Kd 1 1 inf", "\"inf\""},
        {"Kd 1 -0.5 1", "\"-0.5\""},
        {"Kd 1 1 1e39", "\"1e39\""},
        {"Kd spectral file.rfl", "Kd needs 3 numbers"},
        {"Ke 1 1 x", "a.mtl:2: Ke \"x\""},
        {"Ks 1 1 -1", "a.mtl:2: Ks"},
        {"Ns -3", "a.mtl:2: Ns"},
        {"d", "a.mtl:2: d needs a number"},
        {"d 1.5", "d \"1.5\": must be a number in [0,1]"},
        {"Tr 2", "a.mtl:2: Tr"},
        {" newmtl# lass", "a.mtl:2: newmtl needs a name"},
        {"Tf 1 1 1.5", "a.mtl:2: Tf"},
        {"d 0.5\nNi nan", "a.mtl:3: Ni"},
        {"d 0.5\nNi 0", "material \"m\": is transparent (d < 1 or Tr > 0) and needs a refractive index"},
        {"d 0.5\nNi 1.5\nTf 1 0 1", "material \"m\": Tf 0"},
        {"Pr 1.01", "a.mtl:2: Pr \"1.01\": must be a number in [0,1]"},
        {"Pr nan", "a.mtl:2: Pr \"nan\": must be a number in [0,1]"},
        {"Pr -0.5", "a.mtl:2: Pr \"-0.5\""},
        {"Pm 2", "a.mtl:2: Pm \"2\": must be a number in [0,1]"},
        {"Pr 0.5\nNi 0.5", "material \"m\": has a coat (Pr) and needs a refractive index Ni from 1 to 100"},
        {"newmtl", "a.mtl:2: newmtl needs a name"},
        {"map_Kd missing.png", "missing.png: no such file"},
        {"map_Kd a.obj", "not a texture"},
    };
    for (const auto& [lines, part] : cases)
        EXPECT_PRED_FORMAT2(IsSubstring, part, user_error([&, line = lines] { load_material(line); })) << lines;

    const std::string obj = "mtllib a.mtl\nusemtl m\n" + corners_of_a_square + "f 1 2 3\n";
    folder.write("a.mtl", "Kd 1 1 1\n");
    EXPECT_USER_ERROR(load(obj), "a.mtl:1: not a material file");
    folder.write("a.mtl", "# nothing\n");
    EXPECT_USER_ERROR(load(obj), "no material");
    folder.write("a.mtl", std::string("newmtl m\0Kd 1 1 1\n", 18));
    EXPECT_USER_ERROR(load(obj), "binary");
    folder.write("a.mtl", "");
    EXPECT_USER_ERROR(load(obj), "empty");
}

TEST_F(MeshFile, MaterialsThatAreNowhereAreGrey) {
    const std::string grey = ": 2 faces without a material are drawn in grey";
    const std::string named = "\nusemtl m\n" + corners_of_a_square + "f 1 2 3\n", unnamed = "usemtl m n\nf 1 3 4\n";
    folder.write("a.mtl", "newmtl m\nKd 1 1 1\n");
    for (const auto& [text, what] :
         {std::pair{"mtllib none.mtl" + named + "f 1 3 4\n", "a.obj:1: there is no material file \"none.mtl\""},
          {"mtllib  none.mtl no.mtl " + named + unnamed, "a.obj:1: there is no material file \"none.mtl no.mtl\""},
          {"mtllib a.mtl\n" + corners_of_a_square + "usemtl x\nf 1 2 3\nusemtl y\nf 1 3 4\n",
           "a.obj:6: there is no material \"x\""}}) {
        const Scene scene = load(text);
        EXPECT_EQ(scene.materials.size(), 1u) << text;
        EXPECT_EQ(scene.materials.at(0).diffuse_albedo, vec3(0.5f)) << text;
        EXPECT_EQ(count_warnings(scene, what + grey), 1u) << text;
        EXPECT_EQ(count_warnings(scene, "a.obj:"), 2u) << text << "the white sky is the other";
    }
    // A face whose material exists keeps it.
    const Scene partly = load("mtllib a.mtl" + named + unnamed);
    EXPECT_EQ(partly.materials.at(partly.triangle_materials.at(0)).diffuse_albedo, vec3(1));
    EXPECT_EQ(partly.materials.at(partly.triangle_materials.at(1)).diffuse_albedo, vec3(0.5f));
    EXPECT_EQ(count_warnings(partly, "a.obj:8: there is no material \"m n\": 1 faces"), 1u);
}

TEST_F(MeshFile, NamesMayHaveSpacesAroundThem) {
    folder.write("a.mtl", "newmtl \t Material #25 \t\nKd 1 1 1\nmap_Kd  \ta b.png \t\n");
    write_png(folder / "a b.png", {1, 1, {9, 9, 9, 255}});
    const Scene scene = load("mtllib \t a.mtl \t\nusemtl  \tMaterial #25 \n" + corners_of_a_square + "f 1 2 3\n");
    EXPECT_EQ(count_warnings(scene, "material"), 0u);
    EXPECT_EQ(scene.textures.size(), 1u);
}

}  // namespace
}  // namespace lab
