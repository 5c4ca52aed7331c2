// Sample indices up to 2^32: no two samples of an image share random numbers, not even the last ones.
#include <set>

#include "support/gpu_test.h"
#include "support/render.h"

namespace lab {
namespace {

class SampleIndexCases : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, SampleIndexCases, testing::ValuesIn(all_backends), own_backend_name);

TEST_P(SampleIndexCases, TheLastSamplesAreRenderedAsAnyOthers) {
    constexpr uint32_t count = 8, last = 0xffffffff;
    const Scene scene = load_shipped_scene("cornell_box.json");
    RenderSettings settings{.width = 24, .height = 20, .samples = count, .backend = GetParam()};
    settings.first_sample = last - count + 1;
    SceneRenderer renderer(scene, settings);
    const FilmImage whole = renderer.render(settings).film;
    settings.samples = 1;
    const auto render_sample = [&](uint32_t index) {
        settings.first_sample = index;
        return renderer.render(settings).film;
    };
    std::vector<glm::dvec3> sums(whole.pixels.size());
    std::set<std::vector<double>> images;
    std::vector<uint32_t> others;  // indices that the last ones would wrap to if an index had fewer bits
    for (uint32_t i = 0; i < count; ++i) {
        const FilmImage film = render_sample(last - i);
        images.insert(pixel_means(film, 0));
        for (size_t p = 0; p < sums.size(); ++p) sums[p] += glm::dvec3(film.pixels[p].sum);
        others.push_back(i);
    }
    for (const int bits : {8, 15, 16, 23, 24, 31}) others.insert(others.end(), {1u << bits, (1u << bits) - 1});
    for (const uint32_t index : others) images.insert(pixel_means(render_sample(index), 0));
    EXPECT_EQ(images.size(), count + others.size());
    for (size_t p = 0; p < sums.size(); ++p)
        ASSERT_LE(glm::distance(glm::dvec3(whole.pixels[p].sum), sums[p]), 1e-6 * glm::length(sums[p]));
}

}  // namespace
}  // namespace lab
