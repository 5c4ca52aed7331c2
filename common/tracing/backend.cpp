#include "tracing/backend.h"

#include <algorithm>
#include <iterator>

namespace lab {

std::vector<std::string> missing_for(Backend backend, const DeviceDescription& device) {
    std::vector<std::string> missing = device.missing;
    for (const char* extension : backend->extensions)
        if (!device.extensions.contains(extension)) missing.emplace_back(extension);
    if (backend->further_needs) std::ranges::move(backend->further_needs(device), std::back_inserter(missing));
    return missing;
}

bool is_supported(Backend backend, const DeviceDescription& device) { return missing_for(backend, device).empty(); }

bool is_suitable(Backend backend, const Device& device, const Scene& scene) {
    return is_supported(backend, device.description()) && (!backend->suits || backend->suits(device, scene));
}

}  // namespace lab
