#include "engine/drivers/selection.h"

#include <gtest/gtest.h>

#include <cstdlib>
#ifdef _WIN32
#include <windows.h>
#endif

#include "engine/drivers/llvmpipe.h"
#include "engine/drivers/traits.h"
#include "engine/kernel_family.h"
#include "tests/harness.h"
#include "xrds/error.h"

namespace xrds {
namespace {

const std::vector<DeviceDescription> kDevices{
    {.index = 0, .name = "llvmpipe (LLVM 15.0.6, 256 bits)", .kind = DeviceKind::cpu, .uuid = std::string(32, '1')},
    {.index = 1, .name = "NVIDIA A10", .kind = DeviceKind::discrete, .uuid = std::string(32, 'a')},
    {.index = 2, .name = "NVIDIA A100", .kind = DeviceKind::discrete, .uuid = std::string(32, 'b')},
    {.index = 3, .name = "Radeon 780M", .kind = DeviceKind::integrated, .uuid = "0123456789abcdef0123456789abcdef"}};

std::string refusal(std::string_view select, std::span<const DeviceDescription> devices = kDevices) {
  try {
    selectDevice(devices, select);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Selection, PrefersADiscreteDevice) {
  EXPECT_EQ(selectDevice(kDevices, ""), 1u);
  EXPECT_EQ(selectDevice(std::span(kDevices).first(1), ""), 0u);
}

TEST(Selection, TakesAnIndex) {
  EXPECT_EQ(selectDevice(kDevices, "0"), 0u);
  EXPECT_EQ(selectDevice(kDevices, "03"), 3u);
}

TEST(Selection, TakesAPartOfTheNameInAnyCase) {
  EXPECT_EQ(selectDevice(kDevices, "radeon"), 3u);
  EXPECT_EQ(selectDevice(kDevices, "LLVMPIPE"), 0u);
  EXPECT_EQ(selectDevice(kDevices, "780"), 3u);
}

TEST(Selection, TakesTheWholeNameBeforeAPart) { EXPECT_EQ(selectDevice(kDevices, "nvidia a10"), 1u); }

TEST(Selection, TakesAUuidWithOrWithoutDashes) {
  EXPECT_EQ(selectDevice(kDevices, "0123456789ABCDEF0123456789abcdef"), 3u);
  EXPECT_EQ(selectDevice(kDevices, "01234567-89ab-cdef-0123-456789abcdef"), 3u);
}

TEST(Selection, NamesTheDevicesWhenNoneFits) {
  for (const char* select : {"4", "99", "Matrox", "ffffffffffffffffffffffffffffffff"}) {
    const std::string text = refusal(select);
    EXPECT_NE(text.find(std::string("\"") + select + "\""), std::string::npos) << text;
    EXPECT_NE(text.find("3: Radeon 780M"), std::string::npos) << text;
  }
}

TEST(Selection, NamesThoseThatFitWhenSeveralDo) {
  const std::string text = refusal("nvidia");
  EXPECT_NE(text.find("1: NVIDIA A10 ("), std::string::npos) << text;
  EXPECT_NE(text.find("2: NVIDIA A100 ("), std::string::npos) << text;
  EXPECT_EQ(text.find("Radeon"), std::string::npos) << text;
}

TEST(Selection, SaysSoWhenThereIsNoDevice) {
  EXPECT_NE(refusal("", {}).find("No Vulkan 1.2 device"), std::string::npos);
}

TEST(Device, ListsTheOpenDevice) {
  const DeviceDescription open = test::gpu().description();
  const auto devices = listDevices();
  ASSERT_LT(open.index, devices.size());
  EXPECT_EQ(devices[open.index].name, open.name);
  EXPECT_EQ(devices[open.index].uuid.size(), 32u);
  EXPECT_FALSE(open.driver.empty());
  EXPECT_GT(open.memoryBytes, 0u);
}

// Wine's driver is a library of the system below, whose environment a program cannot change.
bool isUnderWine() {
#ifdef _WIN32
  return GetProcAddress(GetModuleHandleA("ntdll.dll"), "wine_get_version") != nullptr;
#else
  return false;
#endif
}

TEST(Device, TraitsAreWhatVulkanGuarantees) {
  const DeviceTraits& traits = test::gpu().traits();
  EXPECT_GE(traits.subgroupSize, 1u);
  EXPECT_GE(traits.maxStorageBufferRange, uint64_t{1} << 27);
  EXPECT_GE(traits.maxTexelBufferElements, 65536u);
  EXPECT_GE(traits.maxSharedBytes, 16384u);
  EXPECT_GE(traits.maxGroupInvocations, 128u);
  const bool isCpu = test::gpu().description().kind == DeviceKind::cpu;
  // One 32-bit lane each of the vector width that was asked for.
  if (const char* width = std::getenv("LP_NATIVE_VECTOR_WIDTH"); width && isCpu && !isUnderWine()) {
    EXPECT_EQ(traits.subgroupSize, std::stoul(width) / 32);
  }
}

TEST(Selection, RefusesADriverThatIsKnownToBeWrong) {
  for (const char* driver : {"MoltenVK 1.3.0", "MoltenVK 1.4.2", "MoltenVK 2.0.0", "MoltenVK", "radv Mesa 22.3.6"})
    EXPECT_NO_THROW(checkDriver({.name = "Apple M1", .driver = driver})) << driver;
  for (const char* driver : {"MoltenVK 1.2.9", "MoltenVK 1.2.11", "MoltenVK 0.9"}) {
    try {
      checkDriver({.name = "Apple M1", .driver = driver});
      ADD_FAILURE() << driver;
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(std::string(driver) + " of Apple M1"), std::string::npos) << text;
      EXPECT_NE(text.find("MoltenVK 1.3 or newer"), std::string::npos) << text;
    }
  }
}

TEST(Device, RegistersAreThoseOfItsMaker) {
  EXPECT_EQ(registersOf(0x1002, DeviceKind::discrete), 256u) << "AMD";
  EXPECT_EQ(registersOf(0x10DE, DeviceKind::discrete), 256u) << "NVIDIA";
  EXPECT_EQ(registersOf(0x8086, DeviceKind::integrated), 128u) << "Intel";
  EXPECT_EQ(registersOf(0x106B, DeviceKind::integrated), 128u) << "Apple";
  EXPECT_EQ(registersOf(0x10005, DeviceKind::integrated), 128u) << "Apple, by Mesa";
  EXPECT_EQ(registersOf(0x5143, DeviceKind::integrated), 128u) << "Qualcomm";
  EXPECT_EQ(registersOf(0x13B5, DeviceKind::integrated), 64u) << "ARM";
  EXPECT_EQ(registersOf(0x14E4, DeviceKind::integrated), 64u) << "Broadcom, of the Raspberry Pi";
  EXPECT_GT(registersOf(0x8086, DeviceKind::cpu), 256u);
}

TEST(Llvmpipe, IsKnownByItsVersion) {
  for (const char* driver : {"llvmpipe Mesa 22.3.6 (LLVM 15.0.6)", "llvmpipe Mesa 23.1.9 (LLVM 16.0.6)"})
    EXPECT_EQ(llvmpipeTraits(driver).laneCode, LaneCode::shuffles) << driver;
  for (const char* driver : {"llvmpipe Mesa 25.0.7-2+deb13u1 (LLVM 19.1.7)", "llvmpipe Mesa 23.2.1 (LLVM 15.0.7)"}) {
    EXPECT_EQ(llvmpipeTraits(driver).laneCode, LaneCode::broadcasts) << driver;
    EXPECT_TRUE(llvmpipeTraits(driver).comparesSharedLoads) << driver;
  }
  EXPECT_TRUE(llvmpipeTraits("llvmpipe Mesa 26.2.6-1 (LLVM 22.1.8)").comparesSharedLoads);
  EXPECT_FALSE(llvmpipeTraits("radv Mesa 22.3.6").comparesSharedLoads);
  EXPECT_EQ(llvmpipeTraits("llvmpipe Mesa 26.2.6-1 (LLVM 22.1.8)").laneCode, LaneCode::scalars);
  EXPECT_TRUE(llvmpipeMultiplies("llvmpipe Mesa 26.2.6-1 (LLVM 22.1.8)", 8));
  EXPECT_FALSE(llvmpipeMultiplies("llvmpipe Mesa 26.2.6-1 (LLVM 22.1.8)", 16));
  EXPECT_TRUE(llvmpipeMultiplies("NVIDIA 580.00", 32));
  EXPECT_EQ(llvmpipeTraits("radv Mesa 25.0.7").laneCode, LaneCode::shuffles);
  EXPECT_EQ(llvmpipeTraits("SwiftShader driver").laneCode, LaneCode::shuffles);
}

TEST(KernelFamily, IsTheOneThatSuitsTheDevice) {
  const auto suitable = [](DeviceKind kind, MatrixUnits units) {
    return suitableFamily({.kind = kind, .matrixUnits = units});
  };
  for (const DeviceKind kind : {DeviceKind::discrete, DeviceKind::integrated, DeviceKind::virtualGpu}) {
    EXPECT_EQ(suitable(kind, MatrixUnits::none), KernelFamily::tile);
    EXPECT_EQ(suitable(kind, MatrixUnits::nv), KernelFamily::matrix);
  }
  EXPECT_EQ(suitable(DeviceKind::cpu, MatrixUnits::none), KernelFamily::lane);
}

TEST(KernelFamily, MayBeAskedForWhereItRuns) {
  const DeviceDescription cpu{.name = "a processor", .kind = DeviceKind::cpu}, gpu{.kind = DeviceKind::discrete};
  EXPECT_EQ(chosenFamily(cpu, "plain"), KernelFamily::plain);
  EXPECT_EQ(chosenFamily(cpu, "lane"), KernelFamily::lane);
  EXPECT_EQ(chosenFamily(cpu, "tile"), KernelFamily::tile);
  EXPECT_THROW(chosenFamily(gpu, "lane"), Error);
  EXPECT_THROW(chosenFamily(gpu, "matrix"), Error);
  EXPECT_THROW(chosenFamily(gpu, "fused"), Error);
  EXPECT_EQ(chosenFamily({.matrixUnits = MatrixUnits::khr}, "matrix"), KernelFamily::matrix);
  EXPECT_EQ(chosenFamily({.matrixUnits = MatrixUnits::khr}, "fused"), KernelFamily::fused);
  const DeviceDescription coarse{.matrixUnits = MatrixUnits::khr, .matrixSize = {.halfSums = false}};
  EXPECT_EQ(chosenFamily(coarse, "matrix"), KernelFamily::matrix);
  EXPECT_THROW(chosenFamily(coarse, "fused"), Error);
  try {
    chosenFamily(cpu, "tiles");
    FAIL() << "a name of no family";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "There is no kernel family 'tiles'; choose plain, lane, tile, matrix or fused.");
  }
}

TEST(KernelFamily, OfAnOpenDeviceIsTheOneAskedFor) {
  EXPECT_EQ(Gpu({.kernelFamily = "tile"}).traits().family, KernelFamily::tile);
  EXPECT_THROW(Gpu({.kernelFamily = "matrices"}), Error);
}

TEST(Device, RefusesAnUnknownName) { EXPECT_THROW(Gpu({.select = "a device nobody has"}), Error); }

TEST(Device, TwoMayBeOpenAtOnce) {
  Gpu second({});
  EXPECT_EQ(second.description().name, Gpu({}).description().name);
}

// In a process of its own, because the Vulkan loader reads its environment once.
int tryWithoutDriver() {
#ifdef _WIN32
  _putenv_s("VK_DRIVER_FILES", "no_such_driver.json");
  _putenv_s("VK_ICD_FILENAMES", "no_such_driver.json");
#else
  setenv("VK_DRIVER_FILES", "no_such_driver.json", 1);
  setenv("VK_ICD_FILENAMES", "no_such_driver.json", 1);
#endif
  try {
    if (!listDevices().empty()) return 2;
    Gpu gpu({});
  } catch (const Error& error) {
    std::fprintf(stderr, "Error: %s\n", error.what());
    return 1;
  }
  return 0;
}

TEST(DeviceDeathTest, WithoutADriverTheErrorSaysWhatToInstall) {
  if (isUnderWine()) GTEST_SKIP() << "Wine finds drivers by itself";
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(std::exit(tryWithoutDriver()), testing::ExitedWithCode(1), "Error: No Vulkan 1.2 device .* install");
}

}  // namespace
}  // namespace xrds
