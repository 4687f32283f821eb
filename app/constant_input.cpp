#include "app/constant_input.h"

#include "app/exit_code.h"
#include "app/frame.h"
#include "app/models.h"
#include "xrds/error.h"

namespace xrds {
namespace {

bool isConstant(const Image& image) {
  const auto channels = static_cast<size_t>(image.channels);
  for (size_t i = channels; i < image.pixels.size(); ++i)
    if (image.pixels[i] != image.pixels[i - channels]) return false;
  return true;
}

}  // namespace

std::string constantInput(const std::vector<std::string>& inputs, const std::vector<Image>& images) {
  for (const AuxiliaryInput& input : {kAlbedo, kNormal})
    if (const Image* image = imageOf(inputs, images, input.name); image && isConstant(*image))
      return std::string(input.name);
  return "";
}

bool staysConstant(size_t frameCount, const std::function<bool(size_t)>& hasConstant) {
  const auto isSo = [&](size_t frame) {
    try {
      return hasConstant(frame);
    } catch (const Failure&) {
    } catch (const Error&) {
    }
    return true;
  };
  return isSo(frameCount / 2) && isSo(frameCount - 1);
}

std::filesystem::path modelWithout(const std::string& constantInput, int scale) {
  std::vector<std::string> left;
  if (constantInput == kNormal.name) left.emplace_back(kAlbedo.name);
  return shippedVariant(scale, left);
}

std::string tellConstant(const std::string& constantInput, const std::string& model) {
  return "The " + constantInput + " is the same everywhere; taking model " + model + ".";
}

}  // namespace xrds
