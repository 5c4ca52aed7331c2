// shaders/interface.h: C++ and GLSL agree on the layout of the structs that they share.
#include "shaders/interface.h"

#include "support/gpu_test.h"

namespace lab {
namespace {

#include "shaders/all_structs.h"

// The numbers that interface.comp writes, in the same order.
class Expectation {
  public:
    void expect(const char* field, uint value) { EXPECT_EQ(value, ++counter_) << field; }
    void expect(const char* field, int value) { EXPECT_EQ(std::abs(value), static_cast<int>(++counter_)) << field; }
    void expect(const char* field, float value) { EXPECT_EQ(value, static_cast<float>(++counter_)) << field; }
    void expect(const char* field, const vec3& value) {
        for (int i = 0; i < 3; ++i) expect(field, value[i]);
    }
    void expect(const char* field, const uvec2& value) {
        for (int i = 0; i < 2; ++i) expect(field, value[i]);
    }
    void expect(const char* field, const Camera& camera) {
        for (const vec3& value : {camera.position, camera.forward, camera.right, camera.up}) expect(field, value);
    }

  private:
    uint counter_ = 0;
};

#define EXPECT_FIELD(field) expectation.expect(#field, field)

TEST(Interface, HasTheSameLayoutInCppAndGlsl) {
    const AllStructs all = run_shader<AllStructs>({"interface.comp"}, std::vector<uint>{0}).front();
    Expectation expectation;
    for (int i = 0; i < 2; ++i) {
        EXPECT_FIELD(all.materials[i].diffuse_albedo);
        EXPECT_FIELD(all.materials[i].albedo_texture);
        EXPECT_FIELD(all.materials[i].emission);
        EXPECT_FIELD(all.materials[i].specular_exponent);
        EXPECT_FIELD(all.materials[i].specular_albedo);
        EXPECT_FIELD(all.materials[i].refractive_index);
        EXPECT_FIELD(all.materials[i].absorption);
        for (int column = 0; column < 4; ++column) EXPECT_FIELD(all.instances[i].object_to_world[column]);
        for (int column = 0; column < 3; ++column) EXPECT_FIELD(all.instances[i].normal_to_world[column]);
        EXPECT_FIELD(all.cameras[i]);
        EXPECT_FIELD(all.render_parameters[i].camera);
        EXPECT_FIELD(all.render_parameters[i].image_size);
        EXPECT_FIELD(all.render_parameters[i].seed_key);
        EXPECT_FIELD(all.render_parameters[i].first_sample);
        EXPECT_FIELD(all.render_parameters[i].max_path_length);
        EXPECT_FIELD(all.render_parameters[i].only_path_length);
        EXPECT_FIELD(all.render_parameters[i].background);
        EXPECT_FIELD(all.render_parameters[i].probe_rotation);
        EXPECT_FIELD(all.dispatch_parameters[i].first_block);
        EXPECT_FIELD(all.dispatch_parameters[i].threads_per_pixel);
        EXPECT_FIELD(all.dispatch_parameters[i].samples_per_pixel);
        EXPECT_FIELD(all.dispatch_parameters[i].target_samples);
        EXPECT_FIELD(all.dispatch_parameters[i].first_film_pixel);
        EXPECT_FIELD(all.film_pixels[i].sum);
        EXPECT_FIELD(all.film_pixels[i].compensation);
        EXPECT_FIELD(all.film_pixels[i].difference);
        EXPECT_FIELD(all.film_pixels[i].sample_count);
        EXPECT_FIELD(all.film_pixels[i].invalid_count);
    }
}

}  // namespace
}  // namespace lab
