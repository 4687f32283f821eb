#include "viewer/display/panel.h"

#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_vulkan.h>

#include "viewer/display/file_dialog.h"
#include "viewer/display/overlay.h"
#include "viewer/display/panel_parts.h"

namespace xrds {
namespace {

void setStyle(float scale) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = {};
  ImGui::StyleColorsDark();
  style.WindowRounding = 0;
  style.FrameRounding = style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.WindowPadding = {10, 8};
  style.ItemSpacing = {6, 5};
  style.Colors[ImGuiCol_WindowBg] = {0.09F, 0.09F, 0.10F, 1};
  style.Colors[ImGuiCol_Header] = {0.20F, 0.22F, 0.26F, 1};
  style.Colors[ImGuiCol_TextDisabled] = {0.60F, 0.62F, 0.66F, 1};
  style.Colors[ImGuiCol_PopupBg] = {0.12F, 0.12F, 0.13F, 1};
  style.ScaleAllSizes(scale);
}

// Dear ImGui changed how its renderer gets the render pass, and uploads the letters itself from 1.90 on.
void startRenderer(ImGui_ImplVulkan_InitInfo& info, VkRenderPass renderPass, VulkanDevice& gpu) {
#if IMGUI_VERSION_NUM >= 19240
  info.PipelineInfoMain.RenderPass = renderPass;
#elif IMGUI_VERSION_NUM >= 19030
  info.RenderPass = renderPass;
#endif
#if IMGUI_VERSION_NUM >= 19030
  ImGui_ImplVulkan_Init(&info);
#else
  ImGui_ImplVulkan_Init(&info, renderPass);
#endif
#if IMGUI_VERSION_NUM < 19000
  gpu.runOnce([](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
  ImGui_ImplVulkan_DestroyFontUploadObjects();
#else
  static_cast<void>(gpu);
#endif
}

}  // namespace

Panel::Panel(VulkanDevice& gpu, const Display& display, const Swapchain& swapchain)
    : gpu_(gpu), display_(display), swapchain_(swapchain) {
  constexpr uint32_t kTextures = 8;  // Dear ImGui has one, and a new one before the old is gone
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kTextures};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  pool.maxSets = kTextures;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  checkVulkan(vkCreateDescriptorPool(gpu_.device, &pool, nullptr, &pool_), "vkCreateDescriptorPool");

  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // the panel lies where it lies
  ImGui_ImplGlfw_InitForVulkan(display.window(), true);
  open();
}

Panel::~Panel() {
  ImGui_ImplVulkan_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  vkDestroyDescriptorPool(gpu_.device, pool_, nullptr);
}

// Letters and sizes for the scale of the display, and what draws them.
void Panel::open() {
  scale_ = display_.scale();
  unit_ = display_.pixelsPerUnit();
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  ImFontConfig font;
  font.SizePixels = std::round(13 * scale_);  // drawn for 13 pixels: sharp at whole multiples
  io.Fonts->AddFontDefault(&font);
  io.FontGlobalScale = 1 / unit_;
  setStyle(scale_ / unit_);
  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = gpu_.instance;
  info.PhysicalDevice = gpu_.physicalDevice;
  info.Device = gpu_.device;
  info.QueueFamily = gpu_.queueFamily;
  info.Queue = gpu_.queue;
  info.DescriptorPool = pool_;
  info.MinImageCount = 2;
  info.ImageCount = std::max(swapchain_.imageCount(), 2u);
  info.CheckVkResultFn = [](VkResult result) { checkVulkan(result, "Dear ImGui"); };
  startRenderer(info, swapchain_.renderPass(), gpu_);
}

void Panel::rescale() {
  if (scale_ == display_.scale() && unit_ == display_.pixelsPerUnit()) return;
  ImGui_ImplVulkan_Shutdown();
  checkVulkan(vkResetDescriptorPool(gpu_.device, pool_, 0), "vkResetDescriptorPool");
  open();
}

bool Panel::takesMouse() const { return ImGui::GetIO().WantCaptureMouse; }
bool Panel::takesKeys() const { return ImGui::GetIO().WantTextInput; }

uint32_t Panel::width(const ViewState& view, uint32_t displayWidth) const {
  const PanelPlace place = panelPlace(view.panel, view.unfolded, static_cast<float>(displayWidth) / scale_);
  return place == PanelPlace::beside ? static_cast<uint32_t>(kPanelWidth * scale_) : 0;
}

// Older ones of Dear ImGui take the mouse's state, newer ones its changes.
void Panel::applyPretended() const {
  if (!pretended_) return;
  ImGuiIO& io = ImGui::GetIO();
  const ImVec2 at{static_cast<float>(pretended_->x) / unit_, static_cast<float>(pretended_->y) / unit_};
#if IMGUI_VERSION_NUM >= 18700
  io.AddMousePosEvent(at.x, at.y);
  io.AddMouseButtonEvent(0, pretended_->pressed);
#else
  io.MousePos = at;
  io.MouseDown[0] = pretended_->pressed;
#endif
}

void Panel::layOutPanel(PanelModel& model, PanelPlace place, float width, float height) {
  const float scale = scale_ / unit_;
  if (place == PanelPlace::hidden) return;
  if (place == PanelPlace::folded) {
    ImGui::SetNextWindowPos({width, 0}, ImGuiCond_Always, {1, 0});
    ImGui::SetNextWindowBgAlpha(0.7F);
    ImGui::Begin("folded", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize);
    if (ImGui::Button("panel")) model.view.unfolded = true;
    ImGui::End();
    return;
  }
  const float wide = std::min(kPanelWidth * scale, width);
  ImGui::SetNextWindowPos({width - wide, 0});
  ImGui::SetNextWindowSize({wide, height});
  ImGui::SetNextWindowBgAlpha(1);
  ImGui::Begin("panel", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus);
  if (place == PanelPlace::over && ImGui::Button("fold")) model.view.unfolded = false;
  drawPanel(model);
  ImGui::End();
}

void Panel::layOut(PanelModel& model, VkExtent2D extent) {
  ImGui_ImplVulkan_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  applyPretended();
  ImGui::NewFrame();
  const float scale = scale_ / unit_, taken = static_cast<float>(width(model.view, extent.width)) / unit_;
  const ImVec2 area{static_cast<float>(extent.width) / unit_, static_cast<float>(extent.height) / unit_};
  const PanelPlace place = panelPlace(model.view.panel, model.view.unfolded, area.x / scale);
  drawOverlay(model, place, area.x - taken, area.y, scale, unit_);
  layOutPanel(model, place, area.x, area.y);
  if (model.view.help) drawHelp(model.view, scale);
  drawFileDialog(model.browser, scale);
  ImGui::Render();
}

void Panel::draw(VkCommandBuffer commands) { ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands); }

}  // namespace xrds
