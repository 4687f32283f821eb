#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "app/byte_count.h"
#include "app/empty_values.h"
#include "app/failing_with.h"
#include "app/help_format.h"
#include "app/kernel_family.h"
#include "app/layer_options.h"
#include "app/network_options.h"
#include "app/number_pair.h"
#include "app/number_range.h"
#include "app/skip_bound.h"
#include "app/typos.h"
#include "app/utf8_console.h"
#include "viewer/headless.h"
#include "viewer/script_verbs.h"
#include "xrds/auxiliary_input.h"

namespace {

int fail(xrds::ExitCode code, const std::string& message) {
  std::fprintf(stderr, "xrds: %s%s\n", message.c_str(), message.ends_with('.') ? "" : ".");
  return static_cast<int>(code);
}

// A live view's number, or two of files.
std::string validSamples(const std::string& text) {
  return text.find(',') == std::string::npos ? CLI::Range(1, 1 << 20)(text) : xrds::validPair(text);
}

// What is of files alone.
void refuseBesideLive(CLI::App& app) {
  CLI::Option* live = app.get_option("--live");
  for (const char* ofFiles : {"FILES", "--watch", "--reference", "--color", "--aux-colour", "--clean-guides", "--fps",
                              "--temporal-radius", "--motion"})
    app.get_option(ofFiles)->excludes(live);
  for (const xrds::AuxiliaryInput& input : xrds::kAuxiliaryInputs)
    if (CLI::Option* const layer = app.get_option_no_throw("--" + std::string(input.name))) layer->excludes(live);
}

void addOptions(CLI::App& app, xrds::ViewerOptions& options) {
  app.add_option("FILES", options.files,
                 "Colour, auxiliary and reference EXR files in any order; names with #### for a numbered sequence; or "
                 "a folder to watch");
  app.add_flag("--watch", options.watch, "Upscale COLOR and AUX again whenever they are written");
  app.add_option("--live", options.scene, "Trace a scene instead: room, garden, spheres, or a glTF or OBJ file")
      ->type_name("SCENE");
  app.add_option("--live-size", options.liveSize, "Of the low-resolution colour")
      ->type_name("WIDTHxHEIGHT")
      ->capture_default_str();
  app.add_option(
         "--samples", options.samples,
         "With --live: the most samples a pixel of it (default: " + std::to_string(xrds::LiveWanted{}.mostSamples) +
             "). Of files: those of the low- and the "
             "full-resolution render, as in xrds upscale")
      ->check(CLI::Validator(validSamples, "N|LOW,HIGH"));
  app.add_option("--reference", options.reference, "EXR file to compare with")->type_name("EXR");
  app.add_option("--model", options.model,
                 "A shipped model's name or a .safetensors file (default: as xrds upscale chooses it; of a live view "
                 "xrds-x4-mini)")
      ->type_name("MODEL");
  xrds::addPrecision(app, options.precision);
  xrds::addEnsemble(app, options.ensemble);
  xrds::addExposure(app, options.exposure);
  xrds::addWrap(app, options.wrap);
  app.add_flag("--denoise-first", options.denoiseFirst,
               "Networks of Open Image Denoise take the noise out of all images first, as in xrds upscale; needs xrds "
               "import oidn");
  app.add_flag("--clean-guides", options.cleanGuides,
               "With --denoise-first: albedo and normal of the files have no noise, and stay as they are")
      ->needs("--denoise-first");
  app.add_option("--skip", options.skip, "Leave out windows that need no network: off, safe, or N as in xrds upscale")
      ->check(CLI::Validator(xrds::validSkip, "off|safe|N"))
      ->capture_default_str();
  app.add_option("--memory", options.memory,
                 "Device memory to use at most, such as 256M or 2G (default: three quarters of what the device has); a "
                 "frame that needs more is shown tile by tile")
      ->check(CLI::Validator(xrds::validBytes, "BYTES"));
  xrds::addTiles(app, options.tiles);
  app.add_option("--tune", options.tune, "Find the fastest kernels first: never, auto or now, as in xrds upscale")
      ->check(CLI::IsMember({"never", "auto", "now"}))
      ->capture_default_str();
  app.add_option("--fps", options.framesPerSecond, "Frames a second of a sequence")
      ->check(xrds::numberIn(0.1, 1000))
      ->capture_default_str();
  app.add_option(
         "--temporal", options.temporal,
         "Merge the frames of a sequence with those around them, as xrds upscale does, and a live view with what "
         "it has shown: on, off, or auto, live views alone")
      ->check(CLI::IsMember({"on", "off", "auto"}))
      ->capture_default_str();
  xrds::addTemporal(app, options.temporalRadius, options.motion);
  xrds::addDevice(app, options.device);
  xrds::addLayerOptions(app, options.layers);
  app.add_option(
         "--aux-colour", options.auxColour,
         "Colour of the full-resolution render, which is merged into the low-resolution colour: auto, never, or a\n"
         "layer")
      ->type_name("auto|never|LAYER")
      ->capture_default_str();
  app.add_option("--size", options.size, "Of the window (default: as it was left)")->type_name("WIDTHxHEIGHT");
  app.add_option("--frames", options.frames, "Leave after so many upscaled pictures; a sequence plays meanwhile")
      ->type_name("N")
      ->check(CLI::Range(1, std::numeric_limits<int>::max()));
  app.add_option("--screenshot", options.screenshot, "PNG file of the window to write then")
      ->type_name("PNG")
      ->needs("--frames");
  app.add_option("--script", options.script, "File of steps to take, as listed below; leaves after the last")
      ->type_name("FILE");
  app.add_flag("--statistics", options.statistics, "Print what the session took when leaving");
  CLI::Option* headless =
      app.add_flag("--headless", options.headless,
                   "Time the live loop without a window, the camera going round: needs --live and --frames");
  for (const char* ofWindow : {"--screenshot", "--script"}) app.get_option(ofWindow)->excludes(headless);
  refuseBesideLive(app);
  app.add_flag("--validation", options.validation, "With Vulkan's validation layers; their first message is a failure");
  app.footer(
      std::string(
          "H shows the keys. Exit codes are those of xrds --help; 5 also if there is no display.\n\nExamples:\n") +
      "  xrds view color.exr aux.exr reference.exr\n"
      "  xrds view 'color.####.exr' 'aux.####.exr' --fps 24\n"
      "  xrds view --watch color.exr aux.exr\n"
      "  xrds view renders/\n"
      "  xrds view --live room\n\n" +
      xrds::scriptHelp());
}

// What cannot be cancelled, such as reading a large file, ends with the process.
void show(const xrds::ViewerOptions& options) {
  xrds::Viewer viewer(options);
  viewer.run();
  if (viewer.leave()) return;
  std::fflush(stdout);
  std::_Exit(static_cast<int>(xrds::ExitCode::ok));
}

}  // namespace

int main(int argc, char** argv) {
  static const xrds::Utf8Console console;  // std::exit() leaves it, too
  CLI::App app("Shows renders as they are upscaled, in a window.", "xrds view");
  app.formatter(std::make_shared<xrds::HelpFormat>());
  xrds::ViewerOptions options;
  addOptions(app, options);
  try {
    app.parse(argc, argv);
    xrds::checkKernelFamilyVariable();
    xrds::refuseEmptyValues(app);
    if (options.headless)
      xrds::runHeadless(options);
    else
      show(options);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return fail(xrds::ExitCode::usage, xrds::usageSentence(app, error));
  } catch (const xrds::Error& error) {  // of the display or the device
    return fail(xrds::ExitCode::device, error.what());
  } catch (...) {
    const xrds::Failure failure = xrds::failureOf(std::current_exception());
    return fail(failure.code, failure.message);
  }
}
