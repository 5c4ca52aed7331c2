#include "measure/rates.h"

#include <algorithm>

namespace lab {

static Rates run(Renderer& renderer, double seconds) {
    const double start = renderer.device_seconds(), first_samples = renderer.samples();
    const uint64_t first_rays = renderer.rays();
    while (renderer.device_seconds() < start + seconds) renderer.advance(UINT32_MAX);
    const double time = renderer.device_seconds() - start;
    const double pixels = static_cast<double>(renderer.film().width()) * renderer.film().height();
    return {pixels * (renderer.samples() - first_samples) / time, static_cast<double>(renderer.rays() - first_rays) / time};
}

std::vector<std::vector<Rates>> measure_in_turns(const std::vector<Renderer*>& renderers, double seconds, uint32_t runs) {
    std::vector<std::vector<Rates>> rates(renderers.size());
    for (Renderer* renderer : renderers) run(*renderer, seconds);
    for (uint32_t i = 0; i < runs; ++i)
        for (size_t j = 0; j < renderers.size(); ++j) rates[j].push_back(run(*renderers[j], seconds));
    return rates;
}

Rates median(std::vector<Rates> runs) {
    std::ranges::sort(runs, {}, &Rates::rays_per_second);
    return runs[runs.size() / 2];
}

}  // namespace lab
