#include "tests/harness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <random>

#include "engine/bytes.h"
#include "engine/recording.h"
#include "shaders/programs.h"
#include "tests/engine_programs.h"

namespace xrds::test {
namespace {

std::mutex messagesMutex;
std::vector<std::string> messages;
std::unique_ptr<Gpu> openGpu;

void failOnMessages() {
  for (const std::string& message : takeMessages()) ADD_FAILURE() << "validation: " << message;
}

class MessageListener : public testing::EmptyTestEventListener {
  void OnTestEnd(const testing::TestInfo&) override { failOnMessages(); }
};

class DeviceCloser : public testing::Environment {
  void TearDown() override {
    openGpu.reset();
    failOnMessages();
  }
};

// The initial bytes of every value of a dispatch, side by side with gaps between, as arena and as host memory.
struct Arena {
  struct Place {
    uint64_t byteOffset = 0, byteSize = 0;
    DataType type = DataType::f32;
    bool isRead = false;
  };
  std::map<ValueId, Place> places;
  std::vector<std::byte> bytes;
  HostMemory host;
};

void place(Arena& arena, ValueId value, DataType type, uint64_t byteSize, bool isRead) {
  Arena::Place& place = arena.places[value];
  place.type = type;
  place.byteSize = std::max(place.byteSize, byteSize);
  place.isRead = place.isRead || isRead;
}

Arena layOut(const KernelCase& kernel, const Contents& contents) {
  Arena arena;
  for (const Binding& binding : kernel.dispatch.bindings)
    if (binding.value != kWeights)
      place(arena, binding.value, binding.type, binding.byteOffset + binding.byteSize, binding.access == Access::read);
  place(arena, kernel.output.value, kernel.output.type, kernel.output.storedByteSize(), false);

  uint64_t end = kBindingAlignment;
  for (auto& [value, place] : arena.places) {
    place.byteOffset = end;
    end += (place.byteSize / kBindingAlignment + 2) * kBindingAlignment;
  }
  arena.bytes.resize(end, std::byte{0xFF});  // NaN in both types
  for (const auto& [value, place] : arena.places) {
    const auto given = contents.find(value);
    if (!place.isRead && given == contents.end()) continue;
    const size_t count = place.byteSize / byteSize(place.type);
    const auto numbers = given == contents.end() ? randomNumbers(count, value + 1) : given->second;
    XRDS_CHECK_EQ(numbers.size(), count);
    const auto bytes = encode(numbers, place.type);
    std::copy(bytes.begin(), bytes.end(), arena.bytes.begin() + static_cast<ptrdiff_t>(place.byteOffset));
    auto& host = arena.host.storage(value, count);
    const auto kept = decode(bytes, place.type);
    std::copy(kept.begin(), kept.end(), host.begin());
  }
  return arena;
}

std::vector<std::byte> runOnDevice(const KernelCase& kernel, const Arena& arena) {
  Buffer buffer(gpu(), arena.bytes.size());
  buffer.upload(0, arena.bytes);
  std::optional<Buffer> weights;
  PlacedDispatch placed{kernel.dispatch, {}};
  for (const Binding& binding : kernel.dispatch.bindings) {
    if (binding.value != kWeights) {
      placed.ranges.push_back(
          {&buffer, arena.places.at(binding.value).byteOffset + binding.byteOffset, binding.byteSize});
      continue;
    }
    const auto bytes = encode(kernel.weights, binding.type);
    weights.emplace(gpu(), bytes.size());
    weights->upload(0, bytes);
    placed.ranges.push_back({&*weights, 0, bytes.size()});
  }
  Recording recording(gpu(), {&placed, 1});
  recording.run();
  std::vector<std::byte> bytes(arena.bytes.size());
  buffer.download(0, bytes);
  return bytes;
}

uint64_t elementOf(const TensorView& view, uint32_t y, uint32_t x, uint32_t c) {
  return (view.storedRow(y) * view.width + x) * view.channelStride + view.channelOffset + c;
}

// Compares the rows and channels of the output and marks their bytes as seen.
void compareOutput(const KernelCase& kernel, Arena& arena, std::span<const std::byte> found, Tolerance tolerance,
                   std::vector<bool>& mayChange) {
  const TensorView& view = kernel.output;
  const uint64_t base = arena.places.at(view.value).byteOffset, elementBytes = byteSize(view.type);
  const RowRange rows = resolve(kernel.rows, view.height);
  const auto numbers = decode(found.subspan(base, view.storedByteSize()), view.type);
  double differences = 0, references = 0, worst = 0;
  uint64_t notFinite = 0, count = 0;
  std::array<uint32_t, 3> worstAt{rows.begin, 0, 0};
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < view.width; ++x)
      for (uint32_t c = 0; c < view.channels; ++c, ++count) {
        const uint64_t element = elementOf(view, y, x, c);
        for (uint64_t byte = 0; byte < elementBytes; ++byte) mayChange[base + element * elementBytes + byte] = true;
        const double device = numbers[element];
        const double expected = arena.host.at(view, y, x, c), difference = std::abs(device - expected);
        references += expected * expected;
        if (!std::isfinite(device)) {
          if (notFinite++ == 0) worstAt = {y, x, c};
          continue;
        }
        differences += difference * difference;
        if (difference > worst && notFinite == 0) worstAt = {y, x, c};
        worst = std::max(worst, difference);
      }
  const double rms = std::sqrt(references / static_cast<double>(count));
  const double differenceRms = std::sqrt(differences / static_cast<double>(count));
  const auto where = testing::Message() << kernel.dispatch.program << " " << view.height << "x" << view.width << "x"
                                        << view.channels << ", worst at row " << worstAt[0] << " column " << worstAt[1]
                                        << " channel " << worstAt[2] << ": "
                                        << arena.host.at(view, worstAt[0], worstAt[1], worstAt[2]) << " expected, "
                                        << numbers[elementOf(view, worstAt[0], worstAt[1], worstAt[2])]
                                        << " found, RMS of the reference " << rms;
  EXPECT_EQ(notFinite, 0u) << where;
  EXPECT_GT(rms, 0) << "the reference is all zero: nothing was compared. " << where;
  EXPECT_LE(differenceRms, tolerance.rms * rms) << where;
  EXPECT_LE(worst, tolerance.max * rms) << where;
}

void expectRestUnchanged(const Arena& arena, std::span<const std::byte> found, const std::vector<bool>& mayChange,
                         const std::string& program) {
  uint64_t changed = 0, first = 0;
  for (uint64_t i = 0; i < found.size(); ++i)
    if (!mayChange[i] && found[i] != arena.bytes[i] && changed++ == 0) first = i;
  std::string where;
  for (const auto& [value, place] : arena.places)
    if (first + kBindingAlignment >= place.byteOffset && first < place.byteOffset + place.byteSize + kBindingAlignment)
      where = "value " + std::to_string(value) + " byte " +
              std::to_string(static_cast<int64_t>(first) - static_cast<int64_t>(place.byteOffset)) + " of " +
              std::to_string(place.byteSize);
  EXPECT_EQ(changed, 0u) << program << " changed bytes outside of its output, first " << where;
}

}  // namespace

DeviceOptions gpuOptions() {
  const char* device = std::getenv("XRDS_TEST_DEVICE");
  DeviceOptions options;
  options.select = device ? device : "";
  options.validation = !std::getenv("XRDS_TEST_NO_VALIDATION");
  options.programs = [](std::string_view name) {
    const auto words = embeddedProgram(name);
    return words.empty() ? engineProgram(name) : words;
  };
  options.onMessage = [](std::string_view message) {
    const std::lock_guard lock(messagesMutex);
    messages.emplace_back(message);
  };
  return options;
}

Gpu& gpu() {
  if (!openGpu) openGpu = std::make_unique<Gpu>(gpuOptions());
  return *openGpu;
}

DeviceTraits traitsOf(KernelFamily family) {
  DeviceTraits traits = gpu().traits();
  traits.family = family;
  if (usesMatrixUnits(family) && traits.matrixUnits == MatrixUnits::none) traits.matrixUnits = MatrixUnits::software;
  return traits;
}

std::vector<std::string> takeMessages() {
  const std::lock_guard lock(messagesMutex);
  return std::exchange(messages, {});
}

std::vector<float> randomNumbers(size_t count, uint32_t seed) {
  std::mt19937 bits(seed);
  std::vector<float> numbers(count);
  for (float& number : numbers) number = static_cast<float>(bits() >> 8) * 0x1p-23f - 1;
  return numbers;
}

std::vector<float> radiances(size_t count, float level) {
  auto values = randomNumbers(count, 7);
  for (size_t i = 0; i < count; ++i) values[i] = i % 5 ? level * std::exp(7 * values[i]) : std::min(values[i], 0.0f);
  return values;
}

double relativeRms(std::span<const float> found, std::span<const float> expected) {
  EXPECT_EQ(found.size(), expected.size());
  double difference = 0, power = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    difference += std::pow(double{found[i]} - expected[i], 2);
    power += std::pow(double{expected[i]}, 2);
  }
  return std::sqrt(difference / power);
}

std::vector<float> smallIntegers(size_t count, uint32_t seed) {
  std::mt19937 bits(seed);
  std::vector<float> numbers(count);
  for (float& number : numbers) number = static_cast<float>(bits() % 9) - 4;
  return numbers;
}

void expectMatchesReference(const KernelCase& kernel, Tolerance tolerance, const Contents& contents) {
  Arena arena = layOut(kernel, contents);
  const auto found = runOnDevice(kernel, arena);
  kernel.reference(arena.host);
  std::vector<bool> mayChange(found.size(), false);
  compareOutput(kernel, arena, found, tolerance, mayChange);
  expectRestUnchanged(arena, found, mayChange, kernel.dispatch.program);
}

}  // namespace xrds::test

// Called by the address sanitizer, if built with it. The driver's compiler and the validation layer leak on unloading,
// and a suppression cannot name a library that is gone.
extern "C" const char* __asan_default_options();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __asan_default_options() {  // NOLINT(bugprone-reserved-identifier)
  return "detect_leaks=0";
}

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::AddGlobalTestEnvironment(new xrds::test::DeviceCloser);
  testing::UnitTest::GetInstance()->listeners().Append(new xrds::test::MessageListener);
  return RUN_ALL_TESTS();
}
