#include "viewer/screen.h"

#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_vulkan.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "clock.h"
#include "error.h"
#include "files/project_folder.h"

namespace lab {
namespace {

void check(VkResult result) {
    if (result < 0) throw DeviceFailure("drawing the user interface failed: " + vk::to_string(vk::Result(result)));
}

// We encode sRGB ourselves, so prefer formats that do not.
vk::SurfaceFormatKHR choose_format(const Device& device) {
    const auto formats = device.physical().getSurfaceFormatsKHR(*device.surface());
    for (const auto& format : formats)
        if (format.format == vk::Format::eB8G8R8A8Unorm || format.format == vk::Format::eR8G8B8A8Unorm) return format;
    return formats.front();
}

// A readable font that most systems have, or else Dear ImGui's bitmap font.
void add_font(ImFontAtlas& fonts, float scale) {
    for (const char* file : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",    // Debian, Ubuntu
                             "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",  // Fedora
                             "/usr/share/fonts/TTF/DejaVuSans.ttf",                // Arch
                             "/System/Library/Fonts/Supplemental/Arial.ttf",       // macOS
                             "C:/Windows/Fonts/segoeui.ttf"})
        if (std::ifstream(file) && fonts.AddFontFromFileTTF(file, std::round(15 * scale))) return;
    ImFontConfig font;
    font.SizePixels = std::round(13 * scale);
    fonts.AddFontDefault(&font);
}

// Draws on top of an image that a blit has written, for presentation.
vk::raii::RenderPass make_render_pass(const Device& device, vk::Format format) {
    const vk::AttachmentDescription attachment({}, format, vk::SampleCountFlagBits::e1, vk::AttachmentLoadOp::eLoad,
                                               vk::AttachmentStoreOp::eStore, vk::AttachmentLoadOp::eDontCare,
                                               vk::AttachmentStoreOp::eDontCare, vk::ImageLayout::eTransferDstOptimal,
                                               vk::ImageLayout::ePresentSrcKHR);
    const vk::AttachmentReference reference(0, vk::ImageLayout::eColorAttachmentOptimal);
    const vk::SubpassDescription subpass({}, vk::PipelineBindPoint::eGraphics, {}, reference);
    const vk::SubpassDependency after_blit(VK_SUBPASS_EXTERNAL, 0, vk::PipelineStageFlagBits::eTransfer,
                                           vk::PipelineStageFlagBits::eColorAttachmentOutput, vk::AccessFlagBits::eTransferWrite,
                                           vk::AccessFlagBits::eColorAttachmentRead | vk::AccessFlagBits::eColorAttachmentWrite);
    return {device.handle(), vk::RenderPassCreateInfo({}, attachment, subpass, after_blit)};
}

}  // namespace

Screen::Screen(const Device& device, const Window& window) : device_(&device), window_(&window), format_(choose_format(device)) {
    render_pass_ = make_render_pass(device, format_.format);
    constexpr uint32_t texture_count = 8;  // for the user interface: its font
    const vk::DescriptorPoolSize textures(vk::DescriptorType::eCombinedImageSampler, texture_count);
    descriptor_pool_ = {device.handle(), vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                                      texture_count, textures)};
    command_pool_ = {device.handle(), {vk::CommandPoolCreateFlagBits::eResetCommandBuffer, device.queue_family()}};
    commands_ = std::move(vk::raii::CommandBuffers(device.handle(), {*command_pool_, vk::CommandBufferLevel::ePrimary, 1})[0]);
    fence_ = {device.handle(), vk::FenceCreateInfo()};
    acquired_ = {device.handle(), vk::SemaphoreCreateInfo()};
    make_swapchain();
    start_user_interface();
}

Screen::~Screen() {
    const auto lock = device_->lock_queue();
    device_->handle().getDispatcher()->vkDeviceWaitIdle(*device_->handle());  // returns at once if the device is lost
    ImGui_ImplVulkan_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Screen::start_user_interface() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::StyleColorsDark();
    // Darker knobs, so that the numbers over them can be read.
    ImGui::GetStyle().Colors[ImGuiCol_SliderGrab] = ImVec4(0.16f, 0.36f, 0.62f, 1);
    ImGui::GetStyle().Colors[ImGuiCol_SliderGrabActive] = ImVec4(0.2f, 0.44f, 0.76f, 1);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // write no settings file
    const float scale = window_->scale();
    add_font(*io.Fonts, scale);
    ImGui::GetStyle().FramePadding.y = 2;  // fits all controls into a window 700 pixels high
    ImGui::GetStyle().ScaleAllSizes(scale);
    ImGui_ImplGlfw_InitForVulkan(window_->handle(), true);

    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = *device_->instance();
    info.PhysicalDevice = *device_->physical();
    info.Device = *device_->handle();
    info.QueueFamily = device_->queue_family();
    info.Queue = *device_->queue();
    info.PipelineCache = *device_->pipeline_cache();
    info.DescriptorPool = *descriptor_pool_;
    info.MinImageCount = 2;
    info.ImageCount = std::max(2u, static_cast<uint32_t>(targets_.size()));
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    info.CheckVkResultFn = check;
    if (!ImGui_ImplVulkan_Init(&info, *render_pass_)) throw DeviceFailure("the user interface could not start");
#if IMGUI_VERSION_NUM < 19000
    device_->submit([](const vk::raii::CommandBuffer& commands) { ImGui_ImplVulkan_CreateFontsTexture(*commands); });
    ImGui_ImplVulkan_DestroyFontUploadObjects();
#else
    const auto lock = device_->lock_queue();
    ImGui_ImplVulkan_CreateFontsTexture();
#endif
}

void Screen::make_swapchain() {
    device_->handle().waitIdle();
    const auto& surface = device_->surface();
    const auto limits = device_->physical().getSurfaceCapabilitiesKHR(*surface);
    extent_ = limits.currentExtent;
    if (extent_.width == UINT32_MAX) {
        const uvec2 size = window_->framebuffer_size();
        extent_.width = std::clamp(size.x, limits.minImageExtent.width, limits.maxImageExtent.width);
        extent_.height = std::clamp(size.y, limits.minImageExtent.height, limits.maxImageExtent.height);
    }
    targets_.clear();
    if (extent_.width == 0 || extent_.height == 0) return;  // minimised
    const uint32_t most = limits.maxImageCount == 0 ? UINT32_MAX : limits.maxImageCount;
    vk::SwapchainCreateInfoKHR info({}, *surface, std::min(limits.minImageCount + 1, most), format_.format, format_.colorSpace,
                                    extent_, 1,
                                    vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferDst |
                                        (limits.supportedUsageFlags & vk::ImageUsageFlagBits::eTransferSrc));
    info.preTransform = limits.currentTransform;
    info.compositeAlpha = limits.supportedCompositeAlpha & vk::CompositeAlphaFlagBitsKHR::eOpaque
                              ? vk::CompositeAlphaFlagBitsKHR::eOpaque
                              : vk::CompositeAlphaFlagBitsKHR::eInherit;
    info.presentMode = vk::PresentModeKHR::eFifo;
    info.clipped = true;
    info.oldSwapchain = *swapchain_;
    swapchain_ = vk::raii::SwapchainKHR(device_->handle(), info);
    for (const vk::Image image : swapchain_.getImages()) {
        vk::raii::ImageView view(device_->handle(),
                                 vk::ImageViewCreateInfo({}, image, vk::ImageViewType::e2D, format_.format, {}, whole_image));
        vk::raii::Framebuffer framebuffer(device_->handle(),
                                          vk::FramebufferCreateInfo({}, *render_pass_, *view, extent_.width, extent_.height, 1));
        targets_.push_back(
            {image, std::move(view), std::move(framebuffer), vk::raii::Semaphore(device_->handle(), vk::SemaphoreCreateInfo())});
    }
}

void Screen::begin_frame() {
    if (const uvec2 window = window_->framebuffer_size(); window != size() && window.x > 0 && window.y > 0) {
        const auto lock = device_->lock_queue();
        make_swapchain();
    }
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

double Screen::show(std::span<const Layer> layers) {
    ImGui::Render();
    const uvec2 window_size = window_->framebuffer_size();
    if (window_size.x == 0 || window_size.y == 0) return 0;
    const auto lock = device_->lock_queue();
    if (targets_.empty()) return 0;

    const auto start = Clock::now();
    uint32_t image = 0;
    try {
        // A hidden window may never get an image, but must be able to close.
        constexpr uint64_t longest_wait = 100'000'000;  // ns
        const auto [result, index] = swapchain_.acquireNextImage(longest_wait, *acquired_);
        if (result == vk::Result::eTimeout || result == vk::Result::eNotReady) return seconds_since(start);
        image = index;
    } catch (const vk::OutOfDateKHRError&) {
        make_swapchain();  // the next frame will be shown
        return seconds_since(start);
    }
    double waited = seconds_since(start);

    const Target& target = targets_[image];
    commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    record(commands_, target, layers);
    commands_.end();
    const vk::PipelineStageFlags stage = vk::PipelineStageFlagBits::eAllCommands;
    device_->queue().submit(vk::SubmitInfo(*acquired_, stage, *commands_, *target.drawn), *fence_);
    if (device_->handle().waitForFences(*fence_, true, UINT64_MAX) != vk::Result::eSuccess)
        throw DeviceFailure("the device did not finish a frame");
    device_->handle().resetFences(*fence_);
    if (captures_) keep_capture();

    const auto presenting = Clock::now();
    bool fits = true;
    try {
        const vk::PresentInfoKHR info(*target.drawn, *swapchain_, image);
        fits = device_->queue().presentKHR(info) == vk::Result::eSuccess;
    } catch (const vk::OutOfDateKHRError&) {
        fits = false;
    }
    waited += seconds_since(presenting);
    if (!fits) make_swapchain();
    return waited;
}

void Screen::record(const vk::raii::CommandBuffer& commands, const Target& target, std::span<const Layer> layers) {
    constexpr auto target_layout = vk::ImageLayout::eTransferDstOptimal;
    const vk::ClearColorValue grey(std::array<float, 4>{0.07f, 0.07f, 0.07f, 1.0f});
    for (const Layer& layer : layers) layer.pass->record(commands, layer.transform, layer.exposure);
    change_layout(commands, target.image, vk::ImageLayout::eUndefined, target_layout);
    commands.clearColorImage(target.image, target_layout, grey, whole_image);
    for (const Layer& layer : layers) draw(commands, target.image, layer);
    commands.beginRenderPass(vk::RenderPassBeginInfo(*render_pass_, *target.framebuffer, {{0, 0}, extent_}),
                             vk::SubpassContents::eInline);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), *commands);
    commands.endRenderPass();
    if (!captures_) return;
    // For keep_capture().
    const size_t bytes = size_t{4} * extent_.width * extent_.height;
    if (!capture_buffer_ || capture_buffer_->size() < bytes)
        capture_buffer_.emplace(*device_, bytes, vk::BufferUsageFlags(), Buffer::Location::host);
    change_layout(commands, target.image, vk::ImageLayout::ePresentSrcKHR, vk::ImageLayout::eTransferSrcOptimal);
    commands.copyImageToBuffer(target.image, vk::ImageLayout::eTransferSrcOptimal, capture_buffer_->handle(),
                               vk::BufferImageCopy(0, 0, 0, whole_layer, {}, {extent_.width, extent_.height, 1}));
    change_layout(commands, target.image, vk::ImageLayout::eTransferSrcOptimal, vk::ImageLayout::ePresentSrcKHR);
}

void Screen::draw(const vk::raii::CommandBuffer& commands, vk::Image image, const Layer& layer) const {
    constexpr auto target_layout = vk::ImageLayout::eTransferDstOptimal;
    const Rectangle& where = layer.where;
    const glm::ivec2 end = where.corner + where.size;
    // False if the window's size has just changed.
    const bool fits =
        glm::all(glm::greaterThan(where.size, glm::ivec2(0))) && glm::all(glm::lessThanEqual(end, glm::ivec2(size())));
    const int width = static_cast<int>(layer.pass->picture().width()), height = static_cast<int>(layer.pass->picture().height());
    // Halves are split between pixels of the picture.
    const auto pixel_at = [&](float fraction) {
        return std::clamp(static_cast<int>(std::lround(fraction * static_cast<float>(width))), 0, width);
    };
    const int from = pixel_at(layer.from), to = pixel_at(layer.to);
    if (!fits || from >= to) return;
    const auto place = [&](int pixel) { return where.corner.x + static_cast<int>(int64_t{pixel} * where.size.x / width); };
    change_layout(commands, image, target_layout, target_layout);  // wait for the previous blit
    const vk::Image source = layer.pass->picture().handle();
    change_layout(commands, source, vk::ImageLayout::eGeneral, vk::ImageLayout::eTransferSrcOptimal);
    const vk::ImageBlit blit(whole_layer, {vk::Offset3D(from, 0, 0), vk::Offset3D(to, height, 1)}, whole_layer,
                             {vk::Offset3D(place(from), where.corner.y, 0), vk::Offset3D(place(to), end.y, 1)});
    // Enlarged pixels stay sharp.
    const bool enlarges = where.size.x >= width;
    commands.blitImage(source, vk::ImageLayout::eTransferSrcOptimal, image, target_layout, blit,
                       enlarges ? vk::Filter::eNearest : vk::Filter::eLinear);
    change_layout(commands, source, vk::ImageLayout::eTransferSrcOptimal, vk::ImageLayout::eGeneral);
}

void Screen::keep_capture() {
    captures_ = false;
    captured_ = {extent_.width, extent_.height, std::vector<uint8_t>(size_t{4} * extent_.width * extent_.height)};
    capture_buffer_->read(captured_.pixels.data(), captured_.pixels.size());
    for (size_t i = 0; i < captured_.pixels.size(); i += 4) {
        if (format_.format == vk::Format::eB8G8R8A8Unorm) std::swap(captured_.pixels[i], captured_.pixels[i + 2]);
        captured_.pixels[i + 3] = 255;
    }
}

// With what light paths added, if they do.
static ComputeKernel make_display_kernel(const Device& device, const Film& film, std::vector<Binding> bindings) {
    ShaderSource source{.file = project_folder() / "shaders" / "engine/display.comp"};
    if (film.splat_unit() > 0) source.defines.emplace_back("SPLATS");
    for (Binding& binding : film.bindings_of_picture()) bindings.push_back(std::move(binding));
    return {device, source, bindings, sizeof(DisplayParameters)};
}

DisplayPass::DisplayPass(const Device& device, const Film& film, std::shared_ptr<StorageImage> picture)
    : device_(&device),
      film_(&film),
      picture_(std::move(picture)),
      largest_value_(device, sizeof(uint32_t), vk::BufferUsageFlagBits::eStorageBuffer),
      kernel_(make_display_kernel(
          device, film,
          {{.index = BINDING_PICTURE, .type = vk::DescriptorType::eStorageImage, .images = {picture_->info()}},
           storage_binding(BINDING_LARGEST_VALUE, largest_value_)})) {}

void DisplayPass::record(const vk::raii::CommandBuffer& commands, DisplayTransform transform, float exposure) const {
    const bool is_radiance = transform == DisplayTransform::exposure;
    DisplayParameters parameters{.film_size = {film_->width(), film_->height()},
                                 .image_size = {picture_->width(), picture_->height()},
                                 .first_film_pixel = 0,
                                 .block_count = count_blocks({picture_->width(), picture_->height()}),
                                 .scale = is_radiance ? std::exp2(exposure) : 1.0f,
                                 .is_srgb = is_radiance,
                                 .divides_by_largest = 0,
                                 .splat_unit = film_->splat_unit()};
    wait_for_writes(commands);
    if (transform == DisplayTransform::maximum) {
        commands.fillBuffer(largest_value_.handle(), 0, VK_WHOLE_SIZE, 0);
        wait_for_writes(commands);
        parameters.divides_by_largest = 2;
        record_parts(commands, parameters);
        wait_for_writes(commands);
        parameters.divides_by_largest = 1;
    }
    record_parts(commands, parameters);
    wait_for_writes(commands);
}

void DisplayPass::record_parts(const vk::raii::CommandBuffer& commands, DisplayParameters parameters) const {
    const uint32_t groups = std::min(parameters.block_count, device_->limits().maxComputeWorkGroupCount[0]);
    const uint32_t film_blocks = count_blocks({film_->width(), film_->height()});
    for (uint32_t block = 0; block < film_blocks;) {
        const FilmWindow window = film_->window_from(block);
        parameters.first_film_pixel = window.first_pixel;
        kernel_.record(commands, &parameters, groups, window.offset());
        block = window.end_block;
    }
}

}  // namespace lab
